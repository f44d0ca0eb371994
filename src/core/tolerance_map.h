#pragma once

#include "core/plane.h"

namespace render2mpeg::core {

/// How far a pixel's luminance may be from the truth: max(absolute, relative x luminance).
struct Tolerance {
    float absolute = 0;  ///< scene-linear luminance, >= 0
    float relative = 0;  ///< share of the pixel's own luminance, >= 0

    bool operator==(const Tolerance&) const = default;
};

/// A tolerance for every pixel of a frame. An empty map means: gather every light point without clustering.
struct ToleranceMap {
    Plane<Tolerance> pixels;

    bool is_reference() const { return pixels.empty(); }
    static ToleranceMap reference() { return {}; }
    static ToleranceMap uniform(int width, int height, Tolerance tolerance) {
        return {Plane<Tolerance>(width, height, tolerance)};
    }
};

}  // namespace render2mpeg::core
