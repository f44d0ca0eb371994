#pragma once

#include <algorithm>
#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// One pixel whose light was gathered a second time, from every light point by itself.
struct AuditedPixel {
    int x = 0, y = 0;
    glm::vec3 radiance{0};  ///< from every light point
    float luminance = 0;    ///< of that
    float error = 0;        ///< by how much the frame's luminance differs from it, >= 0
    float chroma = 0;       ///< by how much its Cr or Cb of linear light do, the larger; >= 0
    float tolerance = 0;    ///< allowed error, given `luminance`
    bool capped = false;    ///< stopped by the largest cut: nothing was promised

    /// Chroma counts for half, as in the bounds (light_kernels.cpp): an eye forgives twice as much of it.
    float noticed() const { return std::max(error, 0.5f * chroma); }
    bool over() const { return noticed() > tolerance; }
};

}  // namespace render2mpeg::renderer
