#pragma once
// Glare: bright light spills over the picture as it does in an eye.
#include <array>
#include <glm/glm.hpp>
#include <memory>

#include "core/glare.h"
#include "core/plane.h"
#include "perceptual/eye.h"

namespace render2mpeg::perceptual {

/// Scatters a share of the light as an eye does (docs/model/display.md), half in a smooth veil, half in the aperture's
/// diffraction pattern [Ritschel2009]. Energy is kept and nothing crosses the borders, so that an even picture stays as
/// it is. Not thread-safe.
class Glare {
  public:
    /// `pixel_aspect` > 0: width over height of a pixel. `exposure`, EV, gives the pupil. Settings that show, size > 0.
    Glare(const core::Glare& settings, int width, int height, float pixel_aspect, float exposure);

    /// The light at this time, from radiance >= 0 and finite. Above 4096 times white it scatters like that.
    core::Plane<glm::vec3> over(const core::Plane<glm::vec3>& radiance, double seconds);

  private:
    /// Point spread function of the eye, by channel.
    struct Scattering {
        std::array<Fourier::Spectrum, 3> kernel;
        std::array<core::Plane<float>, 3> kept;  ///< share of the scattered light that stays in the picture
    };
    Scattering scattering_at(double seconds);
    void see(double seconds);
    core::Plane<glm::vec3> pattern_at(double seconds) const;

    core::Glare settings_;
    int width_, height_;
    int step_;  ///< pixels along a side of a cell that scatters as one
    double pupil_;
    float brightest_;   ///< radiance
    glm::ivec2 reach_;  ///< cells
    Fourier fourier_;
    std::shared_ptr<const Scattering> scattering_;
};

}  // namespace render2mpeg::perceptual
