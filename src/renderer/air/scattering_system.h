#pragma once
// Light that a medium scatters again and again, as linear equations of cells.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace render2mpeg::renderer {

/// x = own + K (albedo x), with rows of K that are not negative and sum up to 1 at most.
class ScatteringSystem {
  public:
    struct Row {
        std::vector<std::uint32_t> cells;
        std::vector<float> weights;
    };

    /// A row as it is summed up.
    class Sums {
      public:
        explicit Sums(std::size_t cells) : weights_(cells, 0.0f) {}
        void add(std::size_t cell, float weight) {
            if (weights_[cell] == 0.0f) touched_.push_back(static_cast<std::uint32_t>(cell));
            weights_[cell] += weight;
        }
        /// Times `part`; nothing is left.
        void move_to(Row& row, float part);

      private:
        std::vector<float> weights_;  ///< by cell
        std::vector<std::uint32_t> touched_;
    };

    explicit ScatteringSystem(std::size_t cells) : rows_(cells) {}
    Row& row(std::size_t cell) { return rows_[cell]; }

    /// Each colour by itself, by generalised conjugate residuals [Eisenstat1983] to a residual of 1e-7 of `own`,
    /// where what cells send to themselves is divided out.
    std::vector<glm::vec3> solve(const std::vector<glm::vec3>& own, const std::vector<glm::vec3>& albedo) const;

  private:
    using Values = std::vector<double>;
    Values solve(const Values& own, const Values& albedo) const;
    Values remaining(const Values& x, const Values& albedo, const Values& own_share) const;

    std::vector<Row> rows_;
};

}  // namespace render2mpeg::renderer
