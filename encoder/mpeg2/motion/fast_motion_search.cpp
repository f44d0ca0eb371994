#include "encoder/mpeg2/motion/fast_motion_search.h"

#include <algorithm>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/motion/motion_compensation.h"
#include "encoder/mpeg2/motion/motion_search.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Half pixels that vectors may stray from those that are known before: each macroblock refines what the one before
/// found.
/// chosen: with exact vectors what one search takes (the f_code grows with it); without them nothing else is known, and
/// vectors come from straying alone.
constexpr int stray = 2 * (search_reach_fast + 3) + 1, stray_unaided = 63;

}  // namespace

FastMotionSearch::FastMotionSearch(const MotionSources* earlier, const MotionSources* later) {
    side_[0].sources = earlier;
    side_[1].sources = later;
    for (Side& side : side_) {
        const MotionSources* s = side.sources;
        if (!s) continue;
        cost_per_bit_ = s->cost_per_bit;
        enough_ = s->enough;
        VectorExtent extent;
        if (s->exact)
            for (const Candidates& c : s->exact->values())
                for (int i = 0; i < c.count; ++i) extent.include(c.vector[static_cast<std::size_t>(i)]);
        if (s->previous && !s->exact)
            for (const Vector v : s->previous->values()) extent.include(v);
        const int more = s->exact ? stray : stray_unaided;
        const auto& [low, high] = extent;
        side.f_code[0] = std::min(f_code_for(low.x - more, high.x + more), s->horizontal_f_code_limit);
        side.f_code[1] = std::min(f_code_for(low.y - more, high.y + more), vertical_f_code_limit);
        side.bits.emplace(side.f_code[0], side.f_code[1], s->zero_is_implicit);
    }
}

VectorRange FastMotionSearch::range(const Side& side, int column, int row) const {
    const Frame& picture = side.sources->picture;
    return vector_range(column, row, picture.columns(), picture.rows(), side.f_code[0], side.f_code[1]);
}

void FastMotionSearch::consider(Found& found, const Side& side, int column, int row, Vector v, Vector predictor) const {
    const auto end = found.tried.begin() + found.evaluations;
    if (std::find(found.tried.begin(), end, v) != end) return;
    *end = v;
    ++found.evaluations;
    const std::uint32_t difference = satd(side.sources->picture, side.sources->reference, column, row, v);
    const float cost = static_cast<float>(difference) + cost_per_bit_ * static_cast<float>((*side.bits)(v, predictor));
    if (cost >= found.cost) return;
    found.vector = v;
    found.difference = difference;
    found.cost = cost;
}

FastMotionSearch::Found FastMotionSearch::begin(int direction, int column, int row, Vector predictor) const {
    const Side& side = side_[direction];
    const VectorRange allowed = range(side, column, row);
    Found found;
    if (side.sources->exact) {
        const Candidates& exact = side.sources->exact->at(column, row);
        for (int i = 0; i < exact.count; ++i)
            consider(found, side, column, row, allowed.clamp(exact.vector[static_cast<std::size_t>(i)]), predictor);
    }
    if (found.evaluations > 0) return found;
    for (const Vector v : {predictor, Vector{}}) consider(found, side, column, row, allowed.clamp(v), predictor);
    return found;
}

void FastMotionSearch::refine(Found& found, int direction, int column, int row, Vector predictor) const {
    if (is_enough(found.difference)) return;
    const Side& side = side_[direction];
    const VectorRange allowed = range(side, column, row);
    for (const Vector v : {predictor, Vector{}}) consider(found, side, column, row, allowed.clamp(v), predictor);
    if (const core::Plane<Vector>* previous = side.sources->previous)
        consider(found, side, column, row, allowed.clamp(previous->at(column, row)), predictor);
    if (is_enough(found.difference)) return;
    const SearchResult searched = search_whole_pixels(
        side.sources->picture, side.sources->reference,
        {column, row, allowed, found.vector, side.sources->search_reach, predictor, cost_per_bit_ / 8});
    found.searches = searched.evaluations;
    if (searched.vectors.size() > 0) consider(found, side, column, row, searched.vectors[0], predictor);
    if (is_enough(found.difference)) return;
    const Vector middle = found.vector;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const Vector v{static_cast<std::int16_t>(middle.x + dx), static_cast<std::int16_t>(middle.y + dy)};
            if (allowed.contains(v)) consider(found, side, column, row, v, predictor);
        }
}

FastMotionSearch::Result FastMotionSearch::best_mode(int column, int row, const Vector (&predictors)[2],
                                                     std::uint8_t* luma) const {
    Result result;
    Found found[2];
    const bool bidirectional = side_[1].sources != nullptr;
    found[0] = begin(0, column, row, predictors[0]);
    if (!bidirectional) {
        refine(found[0], 0, column, row, predictors[0]);
        result.evaluations = found[0].evaluations;
        result.searches = found[0].searches;
        result.mode = {{found[0].vector, {}}, {true, false}};
        return result;
    }
    found[1] = begin(1, column, row, predictors[1]);

    // Of two directions the mean is most often the best; where it is good enough try nothing more.
    std::uint32_t difference = 0;
    const auto take_mean = [&] {
        difference = satd_of_mean(side_[0].sources->picture, side_[0].sources->reference, side_[1].sources->reference,
                                  column, row, {found[0].vector, found[1].vector}, luma);
        ++result.evaluations;
    };
    take_mean();
    if (!is_enough(difference)) {
        const Vector before[2] = {found[0].vector, found[1].vector};
        for (int d = 0; d < 2; ++d) refine(found[d], d, column, row, predictors[d]);
        if (found[0].vector != before[0] || found[1].vector != before[1]) take_mean();
    }

    // Choose between the mean, whose samples are still there, and each direction alone.
    const Found &first = found[0], &second = found[1];
    const float bits = first.cost + second.cost - static_cast<float>(first.difference + second.difference);
    const float mean = static_cast<float>(difference) + bits;
    result.luma_is_predicted = mean <= first.cost && mean <= second.cost;
    if (result.luma_is_predicted)
        result.mode = {{first.vector, second.vector}, {true, true}};
    else if (second.cost < first.cost)
        result.mode = {{{}, second.vector}, {false, true}};
    else
        result.mode = {{first.vector, {}}, {true, false}};
    result.evaluations += first.evaluations + second.evaluations;
    result.searches = first.searches + second.searches;
    return result;
}

}  // namespace render2mpeg::encoder::mpeg2
