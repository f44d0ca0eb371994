#pragma once
// Steps of light through a scene: to the next surface, and on from there by layers, mirrors and glass.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// A ray of the eye, of a photon or of a path, and the bodies of glass that it is in. Bodies cost nothing in scenes
/// without any.
struct LightRay {
    glm::vec3 origin{0}, direction{0, 0, -1};  ///< direction unit
    float time = scene::middle_time;           ///< of the shutter
    bool from_far = false;                     ///< `origin` stands for a place infinitely far: of a sun, of the sky
    Band band = Band::all;
    MediaStack media{};

    /// The nearest surface within `far`.
    Hit meet(const PosedScene& scene, float far = std::numeric_limits<float>::infinity()) const;

    /// Share of light that bodies leave on the segment to a hit. A body whose back is met though the ray never entered
    /// it holds its origin.
    glm::vec3 left_by_bodies(const PosedScene& scene, const Hit& hit);
    /// Share of light that air leaves on a segment, which may be infinite; 1 within bodies.
    glm::vec3 left_by_air(const PosedScene& scene, float distance) const;

    /// The surface as the ray meets it.
    SurfacePoint surface_at(const PosedScene& scene, const Hit& hit, const SurfaceFootprint& footprint = {},
                            Holes holes = Holes::filled) const;

    /// Leaves a surface in a direction, unit.
    void leave(const SurfacePoint& point, glm::vec3 to);
    /// Goes straight on through a layer or thin glass.
    void pass(const PosedScene& scene, const SurfacePoint& point);
    /// Is mirrored by a facet with this normal (on the side of `point.outgoing`); stays above the surface where a bent
    /// normal would send it below.
    void reflect(const SurfacePoint& point, glm::vec3 facet);
    /// Passes the boundary of a body by such a facet; false, and unchanged, where all is reflected.
    bool refract(const PosedScene& scene, const SurfacePoint& point, glm::vec3 facet);
};

/// Whether a point's boundary bends light: that of a solid body of glass.
bool bends_light(const PosedScene& scene, const SurfacePoint& point);

/// Share of light that glass mirrors which passes light straight, alpha apart. A pane's front has it all, its back
/// nothing.
glm::vec3 mirrored_by_pane(const PosedScene& scene, const SurfacePoint& point);

/// The same of any surface, to a ray that goes straight through solid bodies as well: no face mirrors it within.
glm::vec3 mirrored_beside_straight(const PosedScene& scene, const SurfacePoint& point);

/// The facet of a body's boundary that a ray meets: the shading normal, or, of rough glass, one chosen by the density
/// of visible facets.
glm::vec3 facet_of(const SurfacePoint& point, glm::vec2 u);

/// Angle by which rough glass widens a ray between two samples. chosen: half the lobe's width, of a quarter to the
/// whole; textures behind it lose their grain.
float widening_of(const SurfacePoint& point);

/// Difference of places for a neighbour of a ray after a segment, in the plane of this normal: `place` and `turn` are
/// the differences of origins and directions. 0 for rays in the plane. [Igehy1999, "Transfer"]
glm::vec3 transferred(glm::vec3 place, glm::vec3 turn, float distance, glm::vec3 direction, glm::vec3 normal);

/// Where light goes on from a surface.
enum class Scattering : std::uint8_t { layer, diffuse, glossy, mirror, glass, beyond };
inline constexpr std::size_t scatterings = 6;

/// Shares of the light at a surface by where it goes on; 0 where that is left out.
struct ScatteringShares {
    std::array<glm::vec3, scatterings> of{};
    glm::vec3& operator[](Scattering s) { return of[static_cast<std::size_t>(s)]; }
    const glm::vec3& operator[](Scattering s) const { return of[static_cast<std::size_t>(s)]; }
    glm::vec3 sum() const;

    /// Chances of all, whose sum may be above 1: what each would carry on of light of these colours, over all of it.
    /// Colours count alike: light that a surface absorbs ends there, whatever it would do to other light. [Szecsi2003]
    std::array<float, scatterings> chances(glm::vec3 light) const;
};

/// Shares of layers, mirror and glass.
ScatteringShares specular_shares(const SurfacePoint& point);

/// The index of the chance, one after the other, that `number` in [0, 1) falls on, and the size of `chances` where it
/// falls beyond all.
std::size_t chosen(std::span<const float> chances, float number);

}  // namespace render2mpeg::renderer
