#pragma once
// Measures pumping: brightness that coding moves from picture to picture.
#include <cstdint>
#include <optional>

#include "core/motion_field.h"
#include "core/plane.h"

namespace render2mpeg::perceptual {

/// Coding error of luma: decoded minus source, code values.
core::Plane<std::int16_t> luma_error(const core::Plane<std::uint8_t>& decoded, const core::Plane<std::uint8_t>& source);

/// How much the mean errors of 16x16 blocks change along motion from the picture before: root mean square over the
/// blocks of `now`, code values (docs/model/metrics.md). Brightness that rises evenly and is shown as a stair has some,
/// as has an I picture that shows what stands still in other code values than the pictures before. `motion` leads from
/// `now` to `before`; null: nothing moves. Blocks of which less than half has a place there do not count; none where no
/// block counts.
std::optional<double> pumping(const core::MotionField* motion, const core::Plane<std::int16_t>& now,
                              const core::Plane<std::int16_t>& before);

/// Mean change of such blocks' mean luma along motion, code values. A change by more than 8 shows something else and
/// does not count.
std::optional<double> light_change(const core::MotionField* motion, const core::Plane<std::uint8_t>& now,
                                   const core::Plane<std::uint8_t>& before);

/// Mean absolute change of luma along motion (from `now` to `before`), code values; points outside do not count, 0
/// without any. A film's flicker is the excess over its reference's.
double change_along(const core::MotionField& motion, const core::Plane<std::uint8_t>& now,
                    const core::Plane<std::uint8_t>& before);

}  // namespace render2mpeg::perceptual
