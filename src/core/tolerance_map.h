#pragma once
// The border type of tolerances: how far each pixel's light may be off.
#include <algorithm>

#include "core/plane.h"

namespace render2mpeg::core {

/// Tolerance of a pixel's luminance: the larger of an absolute part, scaled down below its background, and a relative
/// part.
struct Tolerance {
    float absolute = 0;    ///< scene-linear luminance, >= 0
    float relative = 0;    ///< share of the pixel's own luminance, >= 0
    float background = 0;  ///< luminance that `absolute` was found for; 0: whatever the pixel gets

    /// `more`: a factor of all but shares of its own light.
    float allows(float luminance, float more = 1) const {
        return std::max(relative * luminance,
                        more * std::max(least(), std::min(absolute, weber_fraction() * luminance)));
    }
    /// The absolute part over its background: relative tolerance where the pixel's luminance is below the background.
    float weber_fraction() const { return background > absolute * 1e-30f ? absolute / background : 1e30f; }
    /// The absolute part of a pixel without light: so dark a pixel may change by more than a share of itself.
    float least() const { return absolute * std::min(weber_fraction(), 1.0f); }

    bool operator==(const Tolerance&) const = default;
};

/// A tolerance for every pixel of a frame. An empty map means: gather every light point without clustering.
struct ToleranceMap {
    Plane<Tolerance> pixels;
    float typical = 0;    ///< share of luminance that most pixels may be off by; 0: tolerances are bounds, no prices
    float means = 1;      ///< (0, 1]: of pixels' tolerances, what they may be off by all together in blocks of 8x8
    float most_rays = 0;  ///< that gather a point's light; 0: as many as it is worth

    bool is_reference() const { return pixels.empty(); }
    static ToleranceMap reference() { return {}; }
    static ToleranceMap uniform(int width, int height, Tolerance tolerance) {
        return {Plane<Tolerance>(width, height, tolerance)};
    }
};

}  // namespace render2mpeg::core
