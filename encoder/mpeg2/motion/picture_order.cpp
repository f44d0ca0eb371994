#include "encoder/mpeg2/motion/picture_order.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "encoder/mpeg2/bitstream/tuning.h"

namespace render2mpeg::encoder::mpeg2 {

std::int64_t next_reference_after(std::int64_t rest, bool ends_intra, int most_b, const PictureFacts& facts) {
    EXPECTS(rest >= 1 && most_b >= 0);
    if (facts.b_pictures) return std::min<std::int64_t>({rest, most_b + 1, *facts.b_pictures + 1});
    // Refer no further than vectors hold, but spare no B picture altogether: half of a distance of two is one.
    std::int64_t furthest = most_b + 1;
    const double nonuniformity = facts.motion_nonuniformity.value_or(0);
    const std::int64_t least = std::min<std::int64_t>(2, furthest);
    if (nonuniformity * static_cast<double>(furthest) > nonuniform_reach)
        furthest = std::clamp(static_cast<std::int64_t>(nonuniform_reach / nonuniformity), least, furthest);
    // The mean of two references is right in the middle between them alone.
    if (facts.light_change.value_or(0) > steady_light) furthest = least;
    std::int64_t runs = (rest + furthest - 1) / furthest;
    // Keep the longest run for the end: an I picture costs the same however far away, a P picture does not.
    if (ends_intra && runs > 1) {
        rest -= (rest + runs - 1) / runs;
        --runs;
    }
    return (rest + runs - 1) / runs;
}

PicturePlan PictureOrder::plan(std::int64_t number, const PictureFacts& facts, bool starts_gop, bool may_open) {
    PicturePlan plan;
    plan.number = number;
    plan.starts_gop = starts_gop;
    if (starts_gop) {
        // B pictures may have been promised this picture as their later reference, but none beyond it.
        const bool is_promised = last_ && later_ > *last_;
        EXPECTS(!is_promised || later_ == number);
        if (!is_promised) intra_place_ = number;
        plan.type = PictureType::intra;
        gop_start_ = earlier_ = later_ = number;
    } else {
        if (number > later_) {
            const std::int64_t next_gop = gop_start_ + gop_;
            const std::int64_t left = std::min(facts.frames_left, next_gop - (may_open ? 0 : 1) - number);
            earlier_ = later_;
            later_ = number - 1 + next_reference_after(left + 1, number + left == next_gop, b_pictures_, facts);
            if (later_ == next_gop) intra_place_ = number;
        }
        plan.type = number < later_ ? PictureType::bidirectional : PictureType::predicted;
        plan.references = {earlier_};
        if (plan.type == PictureType::bidirectional) plan.references.push_back(later_);
    }
    const std::int64_t horizon = std::min(number + facts.frames_left, gop_start_ + gop_ - 1);
    if (plan.type != PictureType::bidirectional && horizon > number) plan.horizon = horizon;
    last_ = number;
    return plan;
}

}  // namespace render2mpeg::encoder::mpeg2
