#pragma once
// A point of a surface as shading needs it.
#include <cstdint>
#include <glm/glm.hpp>

#include "core/surface_address.h"
#include "renderer/geometry/surface_footprint.h"
#include "renderer/geometry/surface_shape.h"
#include "renderer/surface/bsdf.h"

namespace render2mpeg::renderer {

/// Whether a point that is all hole gets its reflectances, which nobody sees there; `bare` takes less time.
enum class Holes : std::uint8_t { filled, bare };

/// All that shading needs to know of one point, its material's textures looked up.
struct SurfacePoint {
    core::SurfaceAddress address;
    std::uint32_t material = 0;
    glm::vec3 position{0};          ///< world
    glm::vec3 geometric_normal{0};  ///< unit, on the side of `outgoing`
    glm::vec3 shading_normal{0};    ///< unit, on the side of `geometric_normal`, normal map applied
    glm::vec3 outgoing{0};          ///< unit, to the eye or to where the path came from
    SmoothSurface smooth;           ///< on the side of `outgoing`
    float position_error = 0;  ///< how far `position` may lie off the surface that rays meet, by rounding; scene units
    Bsdf bsdf;
    glm::vec3 emission{0};     ///< radiance towards `outgoing`
    float alpha = 1;           ///< 0: not there; mask already decided
    bool back_side = false;    ///< seen from behind (of the winding)
    bool bounds_body = false;  ///< light passed by bsdf.transmission is bent by bsdf.ior (dielectric.h)
    bool fibre = false;        ///< of hair: `bsdf` is black, PosedScene::hair_at has its scattering
    bool spreads =
        false;  ///< a share of the light sent on by `bsdf.diffuse` entered elsewhere (subsurface/random_walk.h)
    bool below = false;  ///< stands for that share alone; `bsdf.diffuse` is all of it
    bool unlit = false;  ///< `emission` is its colour, `bsdf` is black

    /// Whether its light is found sample by sample (hair_light.h).
    bool is_sampled() const { return fibre || below; }
};

}  // namespace render2mpeg::renderer
