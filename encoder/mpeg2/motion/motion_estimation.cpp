#include "encoder/mpeg2/motion/motion_estimation.h"

#include <algorithm>
#include <vector>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/kernels/kernels.h"
#include "encoder/mpeg2/motion/search.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// The vectors tried for one macroblock and their differences, so that none is computed twice.
class Trials {
  public:
    struct Trial {
        std::int16_t x, y;
        std::uint32_t difference;

        Vector vector() const { return {x, y}; }
    };

    Trials() : count_(0) {}  // and no word about the rest: dear

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
          trials_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
          limit_(s_.search_range > 0 ? evaluation_limit : s_.evaluation_limit),
          searched_(static_cast<std::size_t>(rows_)) {}

    MotionEstimate run() {
        parallel::for_each(static_cast<std::size_t>(rows_),
                           [this](std::size_t row) { try_sources(static_cast<int>(row)); });
        price_vectors();
        parallel::for_each(static_cast<std::size_t>(rows_), [this](std::size_t row) { settle(static_cast<int>(row)); });
        MotionEstimate choice{std::move(chosen_), 0};
        for (const Trials& t : trials_) choice.evaluations += static_cast<std::uint64_t>(t.count());
        for (const std::uint64_t searched : searched_) choice.evaluations += searched;
        return choice;
    }

  private:
    Trials& trials(int column, int row) {
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
            if (s_.search_range > 0) search_about_best(column, row);
            const Trials& t = trials(column, row);
            left = std::min_element(t.begin(), t.end(), [](const auto& a, const auto& b) {
                       return a.difference < b.difference;
                   })->vector();
            first_.at(column, row) = left;
        }
    }

    /// For measurements only (encoder/mpeg2/motion/search.h).
    void search_about_best(int column, int row) {
        // chosen: an eighth, what absolute differences are of the Hadamard sums that the price is in, for noise.
        const float price = s_.cost_per_bit / 8;
        const Trials& t = trials(column, row);
        const Vector centre = std::min_element(t.begin(), t.end(), [](const auto& a, const auto& b) {
                                  return a.difference < b.difference;
                              })->vector();
        const SearchResult found =
            search(s_.picture, s_.reference, column, row, range(column, row), centre, price, s_.search_range);
        searched_[static_cast<std::size_t>(row)] += static_cast<std::uint64_t>(found.evaluations);
        for (int i = 0; i < found.count; ++i) evaluate(column, row, found.vector[i]);
    }

    /// Prices the second pass's bits by the f_codes that what has been found so far needs. A vector found later may
    /// leave their range.
    void price_vectors() {
        Vector low, high;
        for (const Vector& v : first_.values()) {
            low = {std::min(low.x, v.x), std::min(low.y, v.y)};
            high = {std::max(high.x, v.x), std::max(high.y, v.y)};
        }
        price_x_ = ComponentBits(f_code_for(low.x, high.x));
        price_y_ = ComponentBits(f_code_for(low.y, high.y));
    }

    /// Second pass: the neighbours' vectors, then half pixels about the best.
    void settle(int row) {
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

    Vector cheapest(const Trials& t, Vector prediction) const {
        const Trials::Trial* best = nullptr;
        float best_cost = 0.0f;
        for (const Trials::Trial& trial : t) {
            const float cost = cost_of(trial, prediction);
            if (best && cost >= best_cost) continue;
            best = &trial;
            best_cost = cost;
        }
        return best->vector();
    }

    /// The cheapest ones that come within reach of the best.
    BestVectors shortlist(const Trials& t, Vector prediction) const {
        BestVectors choice;
        float costs[BestVectors::most];
        choice.count = 0;
        for (const Trials::Trial& trial : t) {
            const float cost = cost_of(trial, prediction);
            int place = choice.count;
            while (place > 0 && cost < costs[place - 1]) --place;
            if (place == BestVectors::most) continue;
            choice.count = std::min(choice.count + 1, BestVectors::most);
            for (int i = choice.count - 1; i > place; --i) {
                costs[i] = costs[i - 1];
                choice.vector[i] = choice.vector[i - 1];
                choice.difference[i] = choice.difference[i - 1];
            }
            costs[place] = cost;
            choice.vector[place] = trial.vector();
            choice.difference[place] = trial.difference;
        }
        while (choice.count > 1 && costs[choice.count - 1] > shortlist_reach * costs[0]) --choice.count;
        return choice;
    }

    float cost_of(const Trials::Trial& trial, Vector prediction) const {
        return static_cast<float>(trial.difference) +
               s_.cost_per_bit * static_cast<float>(vector_bits(trial.vector(), prediction));
    }

    /// Bits of macroblock_type and vector. A zero vector needs none in P pictures, but a macroblock type one bit
    /// longer.
    int vector_bits(Vector v, Vector prediction) const {
        if (s_.zero_is_implicit && v.is_zero()) return 2;
        return 1 + price_x_(v.x - prediction.x) + price_y_(v.y - prediction.y);
    }

    void evaluate(int column, int row, Vector v) {
        Trials& t = trials(column, row);
        if (t.count() == limit_ || t.holds(v)) return;
        const Kernels& k = kernels();
        const auto stride = static_cast<std::ptrdiff_t>(s_.picture.y.width());
        const std::uint8_t* here = s_.picture.y.row(row * 16) + column * 16;
        const std::uint8_t* there = s_.reference.y.row(row * 16 + (v.y >> 1)) + column * 16 + (v.x >> 1);
        const int half = (v.x & 1) | (v.y & 1) << 1;
        if (half == 0) {
            t.add(v, k.satd_16x16(here, stride, there, stride));
            return;
        }
        alignas(32) std::uint8_t prediction[256];
        k.predict_16x16(prediction, 16, there, stride, half);
        t.add(v, k.satd_16x16(here, stride, prediction, 16));
    }

    const MotionSources& s_;
    int columns_, rows_;
    core::Plane<Vector> first_;
    core::Plane<BestVectors> chosen_;
    std::vector<Trials> trials_;
    int limit_;                            ///< of trials for one macroblock
    std::vector<std::uint64_t> searched_;  ///< differences that a search computed, per row
    ComponentBits price_x_{1}, price_y_{1};
};

}  // namespace

MotionEstimate estimate_motion(const MotionSources& sources) {
    return MotionEstimator(sources).run();
}

void predict_luma(const Frame& reference, int column, int row, Vector v, std::uint8_t* out) {
    const std::uint8_t* luma = reference.y.row(row * 16 + (v.y >> 1)) + column * 16 + (v.x >> 1);
    kernels().predict_16x16(out, 16, luma, reference.y.width(), (v.x & 1) | (v.y & 1) << 1);
}

void predict_chroma(const Frame& reference, int column, int row, Vector v, Prediction& out) {
    const Kernels& k = kernels();
    // Halve the vector towards zero for chroma. [H262, 7.6.3.7]
    const int x = v.x / 2, y = v.y / 2, half = (x & 1) | (y & 1) << 1;
    const auto chroma_stride = static_cast<std::ptrdiff_t>(reference.cb.width());
    for (int plane = 1; plane <= 2; ++plane) {
        const std::uint8_t* chroma = reference.plane(plane).row(row * 8 + (y >> 1)) + column * 8 + (x >> 1);
        k.predict_8x8(plane == 1 ? out.cb : out.cr, 8, chroma, chroma_stride, half);
    }
}

}  // namespace render2mpeg::encoder::mpeg2
