#pragma once
// How many samples a pixel needs that the shutter or the lens blurs.
#include "core/plane.h"
#include "renderer/view/blur.h"

namespace render2mpeg::renderer {

/// Samples of a tile that is blurred by `blur` pixels (its motion, or its disc across): steps of a quarter of a pixel,
/// or of a quarter of a pixel's area of the disc.
int samples_for(float blur, bool lens, const ExposureSamples& allowed);

/// The most that any pixel gets, a power of two times `wanted.most`.
int most_samples_of(const ExposureSamples& wanted);

/// Where the disc or the motion of something as bright as white may end that the sharp picture shows: 1 there, 0
/// elsewhere. Empty where nobody knows how bright white is.
core::Plane<std::uint8_t> near_white(const Blur& blur, const Frame& seen, const ExposureSamples& wanted);

/// Luminance that the samples of a pixel bring without being lit: lamps, the sky.
class BrightSamples {
  public:
    void add(float luminance);

    /// How many samples the pixel needs, which had `samples`: as many, unless it shows light as bright as white and
    /// its standard error is visible, or should show it (`near_white`) and does not. Otherwise a power of two times as
    /// many, up to most_samples_of.
    int needed(int samples, bool near_white, const ExposureSamples& wanted) const;

  private:
    float sum_ = 0, squares_ = 0, brightest_ = 0;
};

}  // namespace render2mpeg::renderer
