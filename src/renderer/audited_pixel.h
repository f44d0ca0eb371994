#pragma once

namespace render2mpeg::renderer {

/// One pixel whose light was gathered a second time, from every light point by itself.
struct AuditedPixel {
    int x = 0, y = 0;
    float luminance = 0;  ///< from every light point
    float error = 0;      ///< by how much the frame's luminance differs from it, >= 0
    float tolerance = 0;  ///< what was allowed, given `luminance`
    bool over() const { return error > tolerance; }
};

}  // namespace render2mpeg::renderer
