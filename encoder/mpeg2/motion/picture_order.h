#pragma once

#include <cstdint>
#include <optional>

namespace render2mpeg::encoder::mpeg2 {

/// How far from an I or P picture the next P picture is to lie, >= 1, where `rest` >= 1 pictures of the GOP follow.
/// Runs of B pictures are as long as `most_b` and the motion's non-uniformity (encoder/motion_nonuniformity.h;
/// none: even) allow, and as alike as the rest can be parted: so no lone picture is left over at the GOP's end.
std::int64_t next_reference_after(std::int64_t rest, int most_b, std::optional<double> motion_nonuniformity);

}  // namespace render2mpeg::encoder::mpeg2
