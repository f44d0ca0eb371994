#pragma once
// The border type of lit frames: radiance by layers.
#include <cstdint>
#include <glm/glm.hpp>

#include "core/plane.h"

namespace render2mpeg::core {

/// Light from a frame's pixels to the eye: scene-linear RGB with BT.709 primaries, >= 0 and finite. `combined`,
/// `capped` and errors always; the layers only where they are wanted, else empty. Light is kept apart from texture so
/// that it can be interpolated and reused.
struct Radiance {
    std::int64_t frame = 0;
    Plane<glm::vec3> combined;             ///< radiance
    Plane<glm::vec3> emission;             ///< emitted radiance, the sky included
    Plane<glm::vec3> direct_irradiance;    ///< from lights, over pi as for a white Lambert surface
    Plane<glm::vec3> indirect_irradiance;  ///< from light points of the second and later bounces, likewise
    Plane<glm::vec3> albedo;               ///< diffuse reflectance, 0..1
    Plane<glm::vec3> glossy;               ///< radiance by glossy lobes, reflectance included
    Plane<glm::vec3> specular;             ///< radiance seen in mirrors and through glass
    Plane<float> direct_cut;               ///< clusters used, mean over the pixel's gather points
    Plane<float> indirect_cut;
    Plane<float> error;           ///< standard error of luminance, of what is gathered; empty: not known
    Plane<float> shared_error;    ///< likewise of the mean of its block of 8x8 pixels, if all of it erred alike
    Plane<glm::vec3> half;        ///< radiance by half of the paths; the other half is as far on the other side of
                                  ///< `combined`; only of light by paths alone
    Plane<float> record_density;  ///< records that lie in the pixel, seen or hidden; only where light is kept in them
    Plane<float> record_age;      ///< frames since the light that it shows was gathered, mean; 0: in this one
    Plane<float> record_reuse;    ///< share of its gather points that were not gathered in this frame, 0..1
    Plane<float> coverage;        ///< share of the pixel that shows what Visible says of it; only of exposed frames
    Plane<std::uint8_t> capped;   ///< 1: the largest cut came before that was within the tolerance; else 0
};

}  // namespace render2mpeg::core
