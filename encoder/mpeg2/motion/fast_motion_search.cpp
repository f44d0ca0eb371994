#include "encoder/mpeg2/motion/fast_motion_search.h"

#include <algorithm>
#include <limits>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/kernels/kernels.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Half pixels that vectors may stray from those that are known before: each macroblock refines what the one before
/// found.
/// chosen: 4 with exact vectors, twice what refining one takes (the f_code grows with it); without them nothing else is
/// known, and vectors come from straying alone.
constexpr int stray = 4, stray_unaided = 63;

}  // namespace

FastMotionSearch::FastMotionSearch(const MotionSources* earlier, const MotionSources* later) {
    side_[0].sources = earlier;
    side_[1].sources = later;
    for (Side& side : side_) {
        const MotionSources* s = side.sources;
        if (!s) continue;
        cost_per_bit_ = s->cost_per_bit;
        enough_ = s->enough;
        Vector low, high;
        const auto include = [&](Vector v) {
            low = {std::min(low.x, v.x), std::min(low.y, v.y)};
            high = {std::max(high.x, v.x), std::max(high.y, v.y)};
        };
        if (s->exact)
            for (const Candidates& c : s->exact->values())
                for (int i = 0; i < c.count; ++i) include(c.vector[static_cast<std::size_t>(i)]);
        if (s->previous && !s->exact)
            for (const Vector v : s->previous->values()) include(v);
        const int more = s->exact ? stray : stray_unaided;
        side.f_code[0] = std::min(f_code_for(low.x - more, high.x + more), s->horizontal_f_code_limit);
        side.f_code[1] = std::min(f_code_for(low.y - more, high.y + more), vertical_f_code_limit);
        for (const int f_code : side.f_code) side.price.emplace_back(f_code);
    }
}

std::uint32_t FastMotionSearch::difference(const Side& side, int column, int row, Vector v) const {
    const MotionSources& s = *side.sources;
    const auto stride = static_cast<std::ptrdiff_t>(s.picture.y.width());
    const std::uint8_t* here = s.picture.y.row(row * 16) + column * 16;
    const std::uint8_t* there = s.reference.y.row(row * 16 + (v.y >> 1)) + column * 16 + (v.x >> 1);
    const int half = (v.x & 1) | (v.y & 1) << 1;
    const Kernels& k = kernels();
    if (half == 0) return k.satd_16x16(here, stride, there, stride);
    alignas(32) std::uint8_t prediction[256];
    k.predict_16x16(prediction, 16, there, stride, half);
    return k.satd_16x16(here, stride, prediction, 16);
}

VectorRange FastMotionSearch::range(const Side& side, int column, int row) const {
    const Frame& picture = side.sources->picture;
    return vector_range(column, row, picture.columns(), picture.rows(), side.f_code[0], side.f_code[1]);
}

void FastMotionSearch::consider(Found& found, const Side& side, int column, int row, Vector v,
                                Vector prediction) const {
    const auto end = found.tried.begin() + found.evaluations;
    if (std::find(found.tried.begin(), end, v) != end) return;
    *end = v;
    ++found.evaluations;
    const std::uint32_t difference = this->difference(side, column, row, v);
    const bool implicit_zero = side.sources->zero_is_implicit && v.is_zero();
    const int bits = implicit_zero ? 2 : 1 + side.price[0](v.x - prediction.x) + side.price[1](v.y - prediction.y);
    const float cost = static_cast<float>(difference) + cost_per_bit_ * static_cast<float>(bits);
    if (cost >= found.cost) return;
    found.vector = v;
    found.difference = difference;
    found.cost = cost;
}

FastMotionSearch::Found FastMotionSearch::begin(int direction, int column, int row, Vector prediction) const {
    const Side& side = side_[direction];
    const VectorRange allowed = range(side, column, row);
    Found found;
    if (side.sources->exact) {
        const Candidates& exact = side.sources->exact->at(column, row);
        for (int i = 0; i < exact.count; ++i)
            consider(found, side, column, row, allowed.clamp(exact.vector[static_cast<std::size_t>(i)]), prediction);
    }
    if (found.evaluations > 0) return found;
    for (const Vector v : {prediction, Vector{}}) consider(found, side, column, row, allowed.clamp(v), prediction);
    return found;
}

void FastMotionSearch::refine(Found& found, int direction, int column, int row, Vector prediction) const {
    if (is_enough(found.difference)) return;
    const Side& side = side_[direction];
    const VectorRange allowed = range(side, column, row);
    for (const Vector v : {prediction, Vector{}}) consider(found, side, column, row, allowed.clamp(v), prediction);
    if (const core::Plane<Vector>* previous = side.sources->previous)
        consider(found, side, column, row, allowed.clamp(previous->at(column, row)), prediction);
    if (is_enough(found.difference)) return;
    const Vector middle = found.vector;
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const Vector v{static_cast<std::int16_t>(middle.x + dx), static_cast<std::int16_t>(middle.y + dy)};
        if (allowed.contains(v)) consider(found, side, column, row, v, prediction);
    }
}

std::uint32_t FastMotionSearch::difference_of_mean(int column, int row, Vector earlier, Vector later,
                                                   std::uint8_t* mean) const {
    alignas(32) std::uint8_t second[256];
    const MotionSources& s = *side_[0].sources;
    predict_luma(s.reference, column, row, earlier, mean);
    predict_luma(side_[1].sources->reference, column, row, later, second);
    kernels().average(mean, second, 256);
    return kernels().satd_16x16(s.picture.y.row(row * 16) + column * 16, s.picture.y.width(), mean, 16);
}

}  // namespace render2mpeg::encoder::mpeg2
