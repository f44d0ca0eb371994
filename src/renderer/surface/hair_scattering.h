#pragma once
// How a fibre of hair scatters light, after [Chiang2016]: all that happens in it at one place of its length.
#include <array>
#include <glm/glm.hpp>

#include "scene/model/hair.h"

namespace render2mpeg::renderer {

/// Where a fibre is met.
struct FibrePlace {
    glm::vec3 axis{0};           ///< the fibre's middle, world
    glm::vec3 tangent{1, 0, 0};  ///< unit, from root to tip
    float radius = 0;
    float across = 0;  ///< -1..1: along cross(tangent, outgoing) from the middle of what is seen
};

/// Scattering at a place of light from a direction, and the density with which its samples choose that.
struct Scattered {
    glm::vec3 share{0};  ///< f_s times the cosine, per steradian
    float density = 0;   ///< per steradian
};

/// Scattering of light towards one direction: a reflection, two ways through, and all that stays longer inside
/// (p = 0, 1, 2, more). Directions are unit and away from the fibre. Energy is kept but for what the fibre absorbs.
class HairScattering {
  public:
    /// `outgoing`: unit, to where the fibre is seen from.
    HairScattering(const scene::Hair& hair, const FibrePlace& place, glm::vec3 outgoing);

    /// Of light that comes from there; integrates to `albedo` and to 1.
    Scattered scattered(glm::vec3 to_light) const;
    /// A direction to light; `u` in [0, 1).
    glm::vec3 sample(float lobe, glm::vec2 u) const;
    /// Albedo of the fibre under even light.
    glm::vec3 albedo() const;

    /// How far a ray from the fibre's middle goes until it is outside, in units of its length.
    float way_out(glm::vec3 direction) const;
    glm::vec3 axis() const { return place_.axis; }

  private:
    static constexpr std::size_t lobes = 4;
    struct Lobe {
        glm::vec3 attenuation{0};  ///< A_p [Chiang2016, eqs. 13, 14]
        float chance = 0;
        float sine = 0, cosine = 1;  ///< of the outgoing angle, turned by the tilt of the scales
        float variance = 0;          ///< of M_p
        float turn = 0;              ///< by which light turns about the fibre
        float shift = 0;             ///< of the logarithm of M_p
    };
    struct Angles {
        float sine, cosine, azimuth;
    };
    Angles angles(glm::vec3 direction) const;
    static float longitudinal(const Lobe& lobe, const Angles& in);
    float azimuthal(std::size_t p, float azimuth) const;

    FibrePlace place_;
    glm::vec3 towards_, beside_;  ///< with the tangent a frame; the first has azimuth 0
    std::array<Lobe, lobes> lobes_;
    float scale_ = 0, trim_ = 0;  ///< of the logistic distribution; its inverse area within a half turn
};

}  // namespace render2mpeg::renderer
