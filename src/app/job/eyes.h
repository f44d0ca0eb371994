#pragma once
// Both eyes' pictures in one, and back.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/frame_packing.h"
#include "core/mattes.h"
#include "core/motion_field.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "core/visible.h"
#include "scene/model/stereo.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::app {

/// The eyes of a film: a single one, or the left and the right one, in this order.
std::span<const scene::Eye> eyes_of(core::FramePacking packing);

/// " for two eyes (side-by-side)"; empty for one.
std::string eyes_text(core::FramePacking packing);

/// The format of the picture that holds those of all eyes.
scene::PictureFormat packed(scene::PictureFormat of_eye, core::FramePacking packing);
/// The format of each eye's part of it, at least one pixel.
scene::PictureFormat of_eye(scene::PictureFormat whole, core::FramePacking packing);

// Pictures of all eyes, which all have one size, as one: without stereo the only one, as it is.
core::Visible packed(std::vector<core::Visible> eyes, core::FramePacking packing);
core::Radiance packed(std::vector<core::Radiance> eyes, core::FramePacking packing);
core::Mattes packed(std::vector<core::Mattes> eyes, core::FramePacking packing);
core::ToleranceMap packed(std::vector<core::ToleranceMap> eyes, core::FramePacking packing);
/// Points that leave their eye's part of the picture are of class `none`: beyond it is the other eye's.
core::MotionField packed(std::vector<core::MotionField> eyes, core::FramePacking packing);

/// The part of one eye, by its place among eyes_of().
core::ToleranceMap part_of(const core::ToleranceMap& whole, core::FramePacking packing, std::size_t eye);
core::MotionField part_of(const core::MotionField& whole, core::FramePacking packing, std::size_t eye);

/// Light that the left eye sees as the right one would, roughly. A pixel that shows what the left picture shows has its
/// light there, another one that of the nearest such pixel in its row. `to_left`: motion of the right eye's pixels.
core::Radiance carried_to_right(const core::Radiance& left, const core::Visible& seen_left,
                                const core::Visible& seen_right, const core::MotionField& to_left);

}  // namespace render2mpeg::app
