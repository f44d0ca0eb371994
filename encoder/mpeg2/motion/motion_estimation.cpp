#include "encoder/mpeg2/motion/motion_estimation.h"

#include <algorithm>
#include <vector>

#include "core/smallest.h"
#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/motion/motion_compensation.h"
#include "encoder/mpeg2/motion/motion_search.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// The vectors tried for one macroblock and their differences, so that none is computed twice.
class TriedVectors {
  public:
    struct Trial {
        std::int16_t x, y;
        VectorSource source;
        std::uint32_t difference;

        Vector vector() const { return {x, y}; }
    };

    TriedVectors() : count_(0) {}  // and no word about the rest: dear

    int count() const { return count_; }
    const Trial* begin() const { return trials_; }
    const Trial* end() const { return trials_ + count_; }
    /// Null: not tried.
    const Trial* find(Vector v) const {
        const Trial* at = std::find_if(begin(), end(), [v](const Trial& t) { return t.x == v.x && t.y == v.y; });
        return at == end() ? nullptr : at;
    }
    void add(Vector v, VectorSource source, std::uint32_t difference) {
        trials_[count_++] = {v.x, v.y, source, difference};
    }

  private:
    Trial trials_[evaluation_limit_of_vectors];
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
          climbed_(columns_, rows_),
          chosen_(columns_, rows_),
          trials_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
          work_(static_cast<std::size_t>(rows_)) {}

    MotionEstimate run() {
        parallel::for_each(static_cast<std::size_t>(rows_),
                           [this](std::size_t row) { try_sources(static_cast<int>(row)); });
        set_vector_bits();
        parallel::for_each(static_cast<std::size_t>(rows_), [this](std::size_t row) { refine(static_cast<int>(row)); });
        MotionEstimate choice{std::move(chosen_), {}};
        for (const MotionWork& row : work_) choice.work += row;
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

    /// First pass: exact vectors, zero, the picture before, and the left neighbour's choice.
    void try_sources(int row) {
        Vector left;
        for (int column = 0; column < columns_; ++column) {
            const VectorRange allowed = range(column, row);
            if (s_.exact) {
                const Candidates& exact = s_.exact->at(column, row);
                for (int i = 0; i < exact.count; ++i)
                    evaluate(column, row, exact.vector[static_cast<std::size_t>(i)], VectorSource::exact);
            }
            evaluate(column, row, Vector{}, VectorSource::predicted);
            if (s_.previous)
                evaluate(column, row, allowed.clamp(s_.previous->at(column, row)), VectorSource::predicted);
            evaluate(column, row, allowed.clamp(left), VectorSource::predicted);
            const auto& best = least_difference(trials(column, row));
            if (best.difference > s_.good_enough) search(column, row, best.vector(), left);
            left = least_difference(trials(column, row)).vector();
            first_.at(column, row) = left;
        }
    }

    static const TriedVectors::Trial& least_difference(const TriedVectors& t) {
        return *std::min_element(t.begin(), t.end(),
                                 [](const auto& a, const auto& b) { return a.difference < b.difference; });
    }

    void search(int column, int row, Vector centre, Vector prediction) {
        const SearchResult found = search_whole_pixels(
            s_.picture, s_.reference,
            {column, row, range(column, row), centre, s_.search_reach, prediction, s_.cost_per_bit / 8});
        for (const Vector& v : found.vectors) evaluate(column, row, v, VectorSource::searched);
        work_[static_cast<std::size_t>(row)].searches += static_cast<std::uint64_t>(found.evaluations);
    }

    /// Counts the second pass's bits with the f_codes that what has been found so far needs. A vector found later may
    /// leave their range.
    void set_vector_bits() {
        VectorExtent extent;
        for (const Vector& v : first_.values()) extent.include(v);
        const auto& [low, high] = extent;
        bits_ = VectorBits(f_code_for(low.x, high.x), f_code_for(low.y, high.y), s_.zero_is_implicit);
    }

    /// Second pass: the neighbours' vectors, half pixels about the best, then the row's choice from its end.
    void refine(int row) {
        Vector left;  // prediction of the vector in the stream
        for (int column = 0; column < columns_; ++column) {
            const VectorRange allowed = range(column, row);
            const Vector above = neighbour(column, row - 1), above_right = neighbour(column + 1, row - 1);
            const Vector middle{median(left.x, above.x, above_right.x), median(left.y, above.y, above_right.y)};
            for (const Vector v :
                 {left, above, middle, above_right, neighbour(column + 1, row), neighbour(column, row + 1)})
                evaluate(column, row, allowed.clamp(v), VectorSource::predicted);

            const TriedVectors& t = trials(column, row);
            left = climb(column, row, cheapest(t, left), left).vector();
            climbed_.at(column, row) = left;
        }
        for (int column = columns_ - 1; column > 0; --column) set_cost_to_go(column - 1, row);
        left = {};
        for (int column = 0; column < columns_; ++column) {
            const TriedVectors& t = trials(column, row);
            shortlist(t, left, chosen_.at(column, row));
            left = chosen_.at(column, row).vector[0];
            work_[static_cast<std::size_t>(row)].chosen.of(t.find(left)->source) += 1;
        }
    }

    /// The cost behind a macroblock, by the likeliest vectors of the next one.
    void set_cost_to_go(int column, int row) {
        core::Smallest<const TriedVectors::Trial*, CostToGo::most> likeliest;
        for (const TriedVectors::Trial& trial : trials(column + 1, row))
            likeliest.add(&trial, cost_of(trial, climbed_.at(column, row)));
        const CostToGo& beyond = chosen_.at(column + 1, row).to_go;
        for (const TriedVectors::Trial* trial : likeliest)
            chosen_.at(column, row)
                .to_go.add(trial->vector(),
                           static_cast<float>(trial->difference) / s_.cost_per_bit + beyond(trial->vector(), bits_));
    }

    /// At most two rounds of half-pel neighbours, each about the cheapest one so far; returns that.
    TriedVectors::Trial climb(int column, int row, TriedVectors::Trial best, Vector prediction) {
        const VectorRange allowed = range(column, row);
        for (int round = 0; round < 2; ++round) {
            const TriedVectors::Trial middle = best;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const Vector v{static_cast<std::int16_t>(middle.x + dx), static_cast<std::int16_t>(middle.y + dy)};
                    if (!allowed.contains(v)) continue;
                    evaluate(column, row, v, middle.source);
                    const TriedVectors::Trial* tried = trials(column, row).find(v);
                    if (tried && cost_of(*tried, prediction) < cost_of(best, prediction)) best = *tried;
                }
            if (best.vector() == middle.vector()) break;
        }
        return best;
    }

    /// Vector chosen in the first pass, zero outside the picture.
    Vector neighbour(int column, int row) const {
        const bool inside = column < columns_ && row >= 0 && row < rows_;
        return inside ? first_.at(column, row) : Vector{};
    }

    TriedVectors::Trial cheapest(const TriedVectors& t, Vector prediction) const {
        return *std::min_element(t.begin(), t.end(), [&](const auto& a, const auto& b) {
            return cost_of(a, prediction) < cost_of(b, prediction);
        });
    }

    /// The cheapest ones, with what is behind them, that come within reach of the best.
    void shortlist(const TriedVectors& t, Vector prediction, BestVectors& vectors) const {
        core::Smallest<const TriedVectors::Trial*, BestVectors::most> best;
        for (const TriedVectors::Trial& trial : t) {
            const float cost = cost_of(trial, prediction);
            if (best.size() == BestVectors::most && cost >= best.key(BestVectors::most - 1)) continue;
            best.add(&trial, cost + s_.cost_per_bit * vectors.to_go(trial.vector(), bits_));
        }
        best.drop_above(shortlist_reach * best.key(0));
        vectors.count = best.size();
        for (int i = 0; i < best.size(); ++i) {
            vectors.vector[i] = best[i]->vector();
            vectors.difference[i] = best[i]->difference;
        }
    }

    float cost_of(const TriedVectors::Trial& trial, Vector prediction) const {
        return static_cast<float>(trial.difference) +
               s_.cost_per_bit * static_cast<float>(bits_(trial.vector(), prediction));
    }

    void evaluate(int column, int row, Vector v, VectorSource source) {
        TriedVectors& t = trials(column, row);
        if (t.count() == s_.evaluation_limit || t.find(v)) return;
        t.add(v, source, satd(s_.picture, s_.reference, column, row, v));
        work_[static_cast<std::size_t>(row)].evaluations.of(source) += 1;
    }

    const MotionSources& s_;
    int columns_, rows_;
    core::Plane<Vector> first_, climbed_;  ///< the best so far, after each pass's search
    core::Plane<BestVectors> chosen_;
    std::vector<TriedVectors> trials_;
    std::vector<MotionWork> work_;  ///< of each row
    VectorBits bits_{1, 1, false};
};

}  // namespace

MotionEstimate estimate_motion(const MotionSources& sources) {
    return MotionEstimator(sources).run();
}

}  // namespace render2mpeg::encoder::mpeg2
