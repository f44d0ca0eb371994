#pragma once
// When samples of a pixel see the scene, and through which part of the lens.
#include <glm/glm.hpp>
#include <vector>

#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Pixels of a square of this side have patterns of their own; then they repeat. The same in every frame: what is still
/// stays still.
inline constexpr int dither_side = 4;
inline constexpr int dither_classes = dither_side * dither_side;

/// Of a pixel, 0..15: neighbours are far apart in the order [Bayer1973].
int dither_class(int x, int y);

/// Samples of a pixel in time and on the lens, where sample_pattern (see.h) says in which part of the pixel.
class ExposurePattern {
  public:
    explicit ExposurePattern(int samples);

    int samples() const { return static_cast<int>(lens_rank_.size()); }

    /// Shutter time of a sample, inside (0, 1): in one of as many strata, whose sixteenths the pixels of a square
    /// share.
    float time(int sample, int dither) const;

    /// Place on the unit disc, by strata of equal area, turned and spread by class; within the aperture of a lens with
    /// blades or a squeeze.
    glm::vec2 lens(int sample, int dither, const scene::CameraLens& lens) const;

  private:
    std::vector<int> lens_rank_;
};

}  // namespace render2mpeg::renderer
