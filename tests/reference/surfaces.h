#pragma once

#include <glm/glm.hpp>
#include <map>
#include <utility>

#include "renderer/surface/posed_scene.h"
#include "tests/reference/scattering.h"
#include "tests/reference/texels.h"

namespace render2mpeg::reference {

/// A point of a surface, as seen from one side.
struct Surface {
    glm::dvec3 position{0};
    glm::dvec3 front{0};     ///< unit normal of the triangle, on the side of `outgoing`
    glm::dvec3 normal{0};    ///< unit, for shading, on the same side
    glm::dvec3 outgoing{0};  ///< unit, to where it is seen from
    std::uint32_t object = 0;
    bool from_behind = false;
    double clearance = 0;  ///< how far off the triangle rays begin
    Look look;

    glm::vec3 origin(glm::dvec3 direction) const {
        return glm::vec3(position + (glm::dot(direction, front) > 0 ? clearance : -clearance) * front);
    }
};

/// What rays meet in the posed scene: points, normals and materials made anew from the animation and its snapshot, by
/// none of the renderer's code. Textures are looked up at points: surfaces should show texels larger than pixels.
class Surfaces {
  public:
    /// Reads the images that materials use.
    explicit Surfaces(const renderer::PosedScene& posed_scene);

    Surface at(const core::SurfaceAddress& address, glm::dvec3 outgoing) const;

    const renderer::PosedScene& posed_scene() const { return posed_scene_; }

  private:
    struct Triangle;
    glm::dvec4 look_up(const scene::TextureUse& use, const Triangle& triangle, bool srgb, bool covers = false) const;
    Look look_at(const scene::Material& material, const Triangle& triangle) const;
    glm::dvec3 mapped_normal(const scene::Material& material, const Triangle& triangle, glm::dvec3 normal) const;

    const renderer::PosedScene& posed_scene_;
    std::map<std::pair<int, bool>, Texels> texels_;  ///< by image, and whether its codes are sRGB's
};

}  // namespace render2mpeg::reference
