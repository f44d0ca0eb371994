#pragma once
// Glare: bright light spills over the picture as it does in an eye.
#include <array>
#include <glm/glm.hpp>
#include <memory>

#include "core/glare.h"
#include "core/plane.h"
#include "perceptual/eye.h"

namespace render2mpeg::perceptual {

/// Scatters a share of a picture's light as an eye does (docs/model/display.md): half of it in a smooth veil, half in
/// the pattern that an aperture with particles and fibres diffracts light into [Ritschel2009]. No light comes from
/// beyond the picture's borders, and what would leave it stays where it is: an even picture stays as it is, and the sum
/// of all light, too. Not for several threads at once.
class Glare {
  public:
    /// For pictures of this size, with pixels `pixel_aspect` > 0 times as wide as high. `exposure`, EV, tells how wide
    /// the pupil is. Settings that show, size > 0.
    Glare(const core::Glare& settings, int width, int height, float pixel_aspect, float exposure);

    /// Scene-linear radiance, >= 0 and finite, as the eye gets it at this time. What is above 4096 times white scatters
    /// as if it were that bright.
    core::Plane<glm::vec3> over(const core::Plane<glm::vec3>& radiance, double seconds);

  private:
    /// What the eye makes of a point of light, by channel.
    struct Scattering {
        std::array<Fourier::Spectrum, 3> kernel;
        std::array<core::Plane<float>, 3> kept;  ///< share of what is scattered that stays in the picture
    };
    Scattering scattering_at(double seconds);
    void see(double seconds);
    core::Plane<glm::vec3> pattern_at(double seconds) const;

    core::Glare settings_;
    int width_, height_;
    int step_;  ///< pixels along a side of what scatters as one
    double pupil_;
    float brightest_;   ///< radiance
    glm::ivec2 reach_;  ///< cells
    Fourier fourier_;
    std::shared_ptr<const Scattering> scattering_;
};

}  // namespace render2mpeg::perceptual
