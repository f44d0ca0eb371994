#pragma once
// Where rays over a hemisphere find most light.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// A piecewise constant density over the unit square that directions are drawn from: near the best one, which is
/// proportional to the root of the mean square of what is found [Vorba2019] (docs/model/gathering.md, eq. 4). Learnt
/// from rays that count no more, or that were drawn before.
class RayGuide {
  public:
    /// Cells along one side. chosen: 16 of 4, 8, 16, by the variance left in bathroom and sponza.
    static constexpr std::uint32_t side = 16, cells = side * side;

    static std::uint32_t cell_of(glm::vec2 u);
    /// The same in another order: neighbours in the square have numbers near each other.
    static std::uint32_t place_of(glm::vec2 u);

    /// A ray drawn from this cell, any place of it as likely, found so much luminance.
    void add(std::uint32_t cell, double luminance) {
        squares_[cell] += luminance * luminance;
        sums_[cell] += luminance;
        ++rays_[cell];
    }

    /// Sets the density by what was added so far.
    void learn();

    /// Variance of a ray drawn by the density over that of one drawn evenly, about; 1 before `learn`.
    double variance_share() const { return variance_share_; }

    struct Drawn {
        glm::vec2 u{0};
        float density = 1;  ///< over the square, > 0
    };
    float density_at(glm::vec2 u) const { return density_[cell_of(u)]; }
    /// The place that an evenly distributed one is mapped to.
    Drawn draw(glm::vec2 u) const;

  private:
    std::array<double, cells> squares_{}, sums_{};
    std::array<std::uint32_t, cells> rays_{};
    std::array<float, cells> density_{};  ///< mean 1
    std::array<float, side + 1> rows_{};  ///< sums up to each row; the last is 1
    double variance_share_ = 1;
};

}  // namespace render2mpeg::renderer
