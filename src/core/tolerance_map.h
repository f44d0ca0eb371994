#pragma once
// The border type of tolerances: how far each pixel's light may be off.
#include <algorithm>

#include "core/plane.h"

namespace render2mpeg::core {

/// How far a pixel's luminance may be from the truth: the larger of an absolute part, in proportion less where the
/// pixel gets less light than it was told for, and a part of its own luminance.
struct Tolerance {
    float absolute = 0;  ///< scene-linear luminance, >= 0
    float relative = 0;  ///< share of the pixel's own luminance, >= 0
    float usual = 0;     ///< luminance that `absolute` was told for; 0: whatever the pixel gets

    float allows(float luminance) const {
        return std::max(relative * luminance, std::max(least(), std::min(absolute, share() * luminance)));
    }
    /// The absolute part over the pixel's luminance, where the pixel's is less than `usual`.
    float share() const { return usual > absolute * 1e-30f ? absolute / usual : 1e30f; }
    /// The absolute part of a pixel without light: what is that dark may change by more than by a share of itself.
    float least() const { return absolute * std::min(share(), 1.0f); }

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
