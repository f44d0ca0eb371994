#pragma once
// Gathers pixels again from every light point, and compares.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/calibration/audited_pixel.h"
#include "renderer/cut/lighting_context.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// A pixel that has anything to gather. Its gather points lie side by side in its tile.
struct LitPixel {
    std::uint32_t tile = 0;
    std::uint32_t first = 0, last = 0;  ///< gather points, `last` not included
};

/// Where in the frame it is.
glm::ivec2 place_of(const Frame& seen, const LitPixel& pixel);

/// Gather points of the pixel there; none: nothing is gathered.
LitPixel pixel_at(const Frame& seen, glm::ivec2 place);

/// In order of their tiles, then of their rows.
std::vector<LitPixel> lit_pixels(const Frame& seen);

/// `count` of the pixels (all, where there are fewer), chosen by dice that only the frame's number decides.
std::vector<LitPixel> drawn(std::vector<LitPixel> pixels, std::size_t count, std::int64_t frame);

/// Half of `count` as whole blocks of 8x8 pixels, as far as such are lit, the rest likewise.
std::vector<LitPixel> drawn_with_blocks(const std::vector<LitPixel>& pixels, std::size_t count, const Frame& seen);

/// As many, one out of each of `count` equal stretches of the list: spread over the picture. Other dice.
std::vector<LitPixel> spread(const std::vector<LitPixel>& pixels, std::size_t count, std::int64_t frame);

/// Radiance of the pixels, >= 0 and finite, with light gathered from every light point by itself. The same for any
/// number of threads.
std::vector<glm::vec3> gather_exactly(const LightingContext& context, const std::vector<LitPixel>& pixels);

/// Holds one pixel of a frame, lit by `tolerance`, against the radiance that it should have.
AuditedPixel compare(glm::ivec2 place, glm::vec3 truth, const core::ToleranceMap& tolerance,
                     const core::Radiance& radiance);

/// Holds the frame, lit by `tolerance`, against that.
std::vector<AuditedPixel> compare(const Frame& seen, const std::vector<LitPixel>& pixels,
                                  const std::vector<glm::vec3>& truth, const core::ToleranceMap& tolerance,
                                  const core::Radiance& radiance);

}  // namespace render2mpeg::renderer
