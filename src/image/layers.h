#pragma once
// Writes multilayer OpenEXR files with Blender's names (docs/pictures.md).
#include <filesystem>
#include <glm/glm.hpp>

#include "core/motion_field.h"
#include "core/plane.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "core/visible.h"
#include "image/cryptomatte.h"
#include "image/image.h"

namespace render2mpeg::image {

/// Writes what a frame is made of as one multilayer OpenEXR with Blender's layer names and motion convention
/// (docs/pictures.md lists them all). Layers that `radiance` does not have are left out; with neither motion, so is
/// Vector. `tolerance` is what the light was gathered by; null or empty: none. `to_previous` and `to_next` lead from
/// this frame to its neighbours; either may be null: the film's first and last frame. The radiance stands under the
/// plain names R, G, B, A too, for viewers that know no layers. `mattes` with their names are Cryptomatte's layers and
/// alpha; empty: neither. Throws core::Error where the file cannot be written.
void write_layers(const std::filesystem::path& path, const core::Visible& visible, const core::Radiance& radiance,
                  const core::MotionField* to_previous, const core::MotionField* to_next, const FrameFacts& facts = {},
                  const core::ToleranceMap* tolerance = nullptr, const core::Mattes& mattes = {},
                  const MatteNames& names = {});

/// Writes a frame's radiance alone: channels R, G, B and A, which is 1 without mattes, as half floats.
void write_frame(const std::filesystem::path& path, const core::Plane<glm::vec3>& radiance,
                 const FrameFacts& facts = {}, const core::Mattes& mattes = {});

}  // namespace render2mpeg::image
