#include "encoder/mpeg2/motion/motion_estimation.h"

#include <algorithm>
#include <vector>

#include "core/smallest.h"
#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/motion/motion_compensation.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// The vectors tried for one macroblock and their differences, so that none is computed twice.
class TriedVectors {
  public:
    struct Trial {
        std::int16_t x, y;
        std::uint32_t difference;

        Vector vector() const { return {x, y}; }
    };

    TriedVectors() : count_(0) {}  // and no word about the rest: dear

    int count() const { return count_; }
    const Trial* begin() const { return trials_; }
    const Trial* end() const { return trials_ + count_; }
    bool holds(Vector v) const {
        return std::any_of(begin(), end(), [v](const Trial& trial) { return trial.x == v.x && trial.y == v.y; });
    }
    void add(Vector v, std::uint32_t difference) { trials_[count_++] = {v.x, v.y, difference}; }

  private:
    Trial trials_[evaluation_limit];
    int count_;
};

std::int16_t median(std::int16_t a, std::int16_t b, std::int16_t c) {
    return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

/// One picture's choice, in two passes over the rows. Rows are independent within a pass: what a row takes from another
/// one is what the first pass left there. So threads change nothing, and a predictor may even lie below.
class MotionEstimator {
  public:
    explicit MotionEstimator(const MotionSources& sources)
        : s_(sources),
          columns_(sources.picture.columns()),
          rows_(sources.picture.rows()),
          first_(columns_, rows_),
          chosen_(columns_, rows_),
          trials_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

    MotionEstimate run() {
        parallel::for_each(static_cast<std::size_t>(rows_),
                           [this](std::size_t row) { try_sources(static_cast<int>(row)); });
        set_vector_bits();
        parallel::for_each(static_cast<std::size_t>(rows_), [this](std::size_t row) { refine(static_cast<int>(row)); });
        MotionEstimate choice{std::move(chosen_), 0};
        for (const TriedVectors& t : trials_) choice.evaluations += static_cast<std::uint64_t>(t.count());
        return choice;
    }

  private:
    TriedVectors& trials(int column, int row) {
        return trials_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                       static_cast<std::size_t>(column)];
    }
    VectorRange range(int column, int row) const {
        return vector_range(column, row, columns_, rows_, s_.horizontal_f_code_limit, vertical_f_code_limit);
    }

    /// First pass: exact vectors, zero, the picture before, and what the left neighbour liked.
    void try_sources(int row) {
        Vector left;
        for (int column = 0; column < columns_; ++column) {
            const VectorRange allowed = range(column, row);
            if (s_.exact) {
                const Candidates& exact = s_.exact->at(column, row);
                for (int i = 0; i < exact.count; ++i) evaluate(column, row, exact.vector[static_cast<std::size_t>(i)]);
            }
            evaluate(column, row, Vector{});
            if (s_.previous) evaluate(column, row, allowed.clamp(s_.previous->at(column, row)));
            evaluate(column, row, allowed.clamp(left));
            const TriedVectors& t = trials(column, row);
            left = std::min_element(t.begin(), t.end(), [](const auto& a, const auto& b) {
                       return a.difference < b.difference;
                   })->vector();
            first_.at(column, row) = left;
        }
    }

    /// Counts the second pass's bits with the f_codes that what has been found so far needs. A vector found later may
    /// leave their range.
    void set_vector_bits() {
        VectorExtent extent;
        for (const Vector& v : first_.values()) extent.include(v);
        const auto& [low, high] = extent;
        bits_ = VectorBits(f_code_for(low.x, high.x), f_code_for(low.y, high.y), s_.zero_is_implicit);
    }

    /// Second pass: the neighbours' vectors, then half pixels about the best.
    void refine(int row) {
        Vector left;  // prediction of the vector in the stream
        for (int column = 0; column < columns_; ++column) {
            const VectorRange allowed = range(column, row);
            const Vector above = neighbour(column, row - 1), above_right = neighbour(column + 1, row - 1);
            const Vector middle{median(left.x, above.x, above_right.x), median(left.y, above.y, above_right.y)};
            for (const Vector v :
                 {left, above, middle, above_right, neighbour(column + 1, row), neighbour(column, row + 1)})
                evaluate(column, row, allowed.clamp(v));

            Vector best = cheapest(trials(column, row), left);
            for (int round = 0; round < 2; ++round) {
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        const Vector v{static_cast<std::int16_t>(best.x + dx), static_cast<std::int16_t>(best.y + dy)};
                        if (allowed.contains(v)) evaluate(column, row, v);
                    }
                const Vector better = cheapest(trials(column, row), left);
                if (better == best) break;
                best = better;
            }
            chosen_.at(column, row) = shortlist(trials(column, row), left);
            left = best;
        }
    }

    /// What the first pass chose, zero outside the picture.
    Vector neighbour(int column, int row) const {
        const bool inside = column < columns_ && row >= 0 && row < rows_;
        return inside ? first_.at(column, row) : Vector{};
    }

    Vector cheapest(const TriedVectors& t, Vector prediction) const {
        const TriedVectors::Trial* best = nullptr;
        float best_cost = 0.0f;
        for (const TriedVectors::Trial& trial : t) {
            const float cost = cost_of(trial, prediction);
            if (best && cost >= best_cost) continue;
            best = &trial;
            best_cost = cost;
        }
        return best->vector();
    }

    /// The cheapest ones that come within reach of the best.
    BestVectors shortlist(const TriedVectors& t, Vector prediction) const {
        core::Smallest<const TriedVectors::Trial*, BestVectors::most> best;
        for (const TriedVectors::Trial& trial : t) best.add(&trial, cost_of(trial, prediction));
        best.drop_above(shortlist_reach * best.key(0));
        BestVectors vectors;
        vectors.count = best.size();
        for (int i = 0; i < best.size(); ++i) {
            vectors.vector[i] = best[i]->vector();
            vectors.difference[i] = best[i]->difference;
        }
        return vectors;
    }

    float cost_of(const TriedVectors::Trial& trial, Vector prediction) const {
        return static_cast<float>(trial.difference) +
               s_.cost_per_bit * static_cast<float>(bits_(trial.vector(), prediction));
    }

    void evaluate(int column, int row, Vector v) {
        TriedVectors& t = trials(column, row);
        if (t.count() == s_.evaluation_limit || t.holds(v)) return;
        t.add(v, satd(s_.picture, s_.reference, column, row, v));
    }

    const MotionSources& s_;
    int columns_, rows_;
    core::Plane<Vector> first_;
    core::Plane<BestVectors> chosen_;
    std::vector<TriedVectors> trials_;
    VectorBits bits_{1, 1, false};
};

}  // namespace

MotionEstimate estimate_motion(const MotionSources& sources) {
    return MotionEstimator(sources).run();
}

}  // namespace render2mpeg::encoder::mpeg2
