#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "app/job/render_job.h"
#include "core/motion_field.h"
#include "core/picture.h"
#include "core/visible.h"

namespace render2mpeg::bench {

/// One frame lit without clustering, and what films are held against there.
struct ReferenceFrame {
    core::Plane<glm::vec3> light;
    core::Picture picture;              ///< not coded
    core::Plane<std::uint8_t> gathers;  ///< 1: the pixel has light to gather; 0: sky, lamps alone, nothing
};

/// What all ways to light and to code one film share.
struct Stage {
    std::vector<std::int64_t> firsts;  ///< first frames of pairs of adjacent ones
    std::map<std::int64_t, ReferenceFrame> reference;
    std::vector<core::Visible> visible;     ///< of every frame
    std::vector<core::MotionField> motion;  ///< of every frame to the one before; of the first to itself
};

/// Sees the film, and lights pairs of frames spread over it. Their light is kept in files in `folder`, named by what
/// the frame shows, by the settings, and by the light of some hundred of its pixels gathered anew: whatever changes
/// them, a texture, a shape or the code that lights, makes another file.
Stage stage_of(const app::RenderJob& film, int pairs, const std::filesystem::path& folder);

}  // namespace render2mpeg::bench
