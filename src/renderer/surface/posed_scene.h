#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "core/isa.h"
#include "core/surface_address.h"
#include "image/sky_map.h"
#include "renderer/base/air.h"
#include "renderer/base/plan.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/surface/dielectric.h"
#include "renderer/surface/hair_scattering.h"
#include "renderer/surface/surface_point.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

class TextureStore;

/// The scene as rays meet it: geometry in a ray tracer, posed at one instant, and textured materials. Everything that
/// is looked up is a function of the animation and the posed snapshot alone, whatever was posed before.
class PosedScene {
  public:
    /// Takes the textures that surfaces use from `store` (none: one of its own) and builds what never moves.
    /// `animation` is complete (scene::complete) and outlives this. Throws core::Error for images that cannot be read.
    PosedScene(const scene::Animation& animation, core::Isa isa, const Plan& plan, TextureStore* store = nullptr);
    /// Another for other instants: it shares what never moves with `posed`, which was posed before. Each may be posed
    /// while the other is looked at.
    explicit PosedScene(const PosedScene& posed);
    ~PosedScene();
    PosedScene(PosedScene&&) noexcept;

    /// Moves everything to where it is in the snapshot; cheap for what has not moved since the last call, nothing at
    /// all for the snapshot that is posed already. The snapshot must outlive all look-ups until the next call.
    void pose(const scene::Snapshot& snapshot);
    const scene::Snapshot& posed() const;

    const RayTracer& tracer() const;
    const scene::Animation& animation() const;

    /// The surface at an address (a Hit's, or a photon's) at the posed instant: geometry, normals and material with its
    /// textures filtered over `footprint`. `outgoing` is unit, to where the surface is seen from (for photons: to where
    /// they came from); it decides which side is looked at, since back faces are shaded like front faces. Reads no
    /// other state: any thread.
    ///
    /// Emission leaves the front (the side from which the winding runs counter-clockwise, mirrored transforms
    /// included), and the back as well where the material is double-sided: emissive light points must keep the same
    /// rule (`front_normal`).
    /// `time`: of the shutter (scene::Sweep).
    SurfacePoint surface_at(const core::SurfaceAddress& address, glm::vec3 outgoing,
                            const SurfaceFootprint& footprint = {}, float time = scene::middle_time) const;

    /// The geometry of a surface alone.
    SurfaceShape shape_at(const core::SurfaceAddress& address, float time) const;

    /// The same place of a surface that lets diffuse light through, as light meets it from the other side: a Lambert
    /// surface of that transmittance, seen from the mirrored direction, without emission.
    SurfacePoint other_side(const SurfacePoint& point, const SurfaceFootprint& footprint = {},
                            float time = scene::middle_time) const;

    /// How a point of a fibre scatters light towards its `outgoing`.
    HairScattering hair_at(const SurfacePoint& point, float time = scene::middle_time) const;

    /// The same where a ray meets the surface from within these media. `band`: what light it carries.
    SurfacePoint surface_in(const MediaStack& media, Band band, const core::SurfaceAddress& address, glm::vec3 outgoing,
                            const SurfaceFootprint& footprint = {}, float time = scene::middle_time,
                            Holes holes = Holes::filled) const;

    /// Medium of the body of glass that an object bounds; null: it bounds none, or the plan bends no light.
    const Medium* medium_within(std::uint32_t object) const;
    /// Whether any object does.
    bool has_bodies() const;

    /// Whether an object's glass lets light pass straight: panes, and all glass that is thin.
    bool passes_straight(std::uint32_t object) const;

    /// Share of light that goes straight through a surface, as shadow rays of that direction have it
    /// (RayTracer::Transmittance).
    glm::vec3 transmittance_at(const core::SurfaceAddress& address, glm::vec3 direction) const;

    /// Where a ray of the shutter's middle goes on that met a hole there.
    glm::vec3 origin_behind(const core::SurfaceAddress& address, glm::vec3 direction) const;

    /// Unit normal of the triangle's front at the posed instant; (0, 0, 1) for a triangle that has shrunk to nothing.
    glm::vec3 front_normal(std::uint32_t object, std::uint32_t primitive) const;

    /// Mean radiance that the front of a triangle emits at the posed instant, texture and animated factor included; 0
    /// for unlit materials, which light nothing.
    glm::vec3 mean_emission(std::uint32_t object, std::uint32_t primitive) const;
    /// The same of a part of it.
    glm::vec3 mean_emission(const core::SurfaceAddress& address, const SurfaceFootprint& footprint) const;

    /// How the unit normal that smooth shading interpolates changes over a footprint: `dx`, `dy` are differences of
    /// normals, 0 on flat triangles. On the side of the triangle's front.
    SurfaceFootprint normal_change(const core::SurfaceAddress& address, const SurfaceFootprint& footprint,
                                   float time = scene::middle_time) const;

    /// Air that dims and scatters light on its way; null: the plan says that the air is clear.
    const Air* air() const;
    /// Light within the volumes of the posed instant, as many as `air` has, or none; kept until volumes are others.
    void light_volumes(std::vector<VolumeLight> lights);
    /// Light within its fog; kept until the next.
    void light_fog(LitFog light);
    void darken_air();

    /// Background where there is no surface, and its light; null where the plan wants neither.
    const image::SkyMap* sky() const;

    /// A line for each image with values that are not finite, and about what of volumes was mended until now.
    std::vector<std::string> notes() const;

    /// CPU seconds that shadow rays' layers took to look at, about (sampled_clock.h): 0 where nothing is translucent.
    double layer_seconds() const;

  private:
    struct Still;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Luminance that gather rays see of a sky at most; light points have what is brighter. chosen: 8 times its mean, so
/// that rays differ by no more than that; infinite for a sky of one colour.
float brightest_of_rays(const image::SkyMap* sky);

/// Where a ray leaves `point` towards `direction`: moved off its surface by a bound of what rounding may be off, not by
/// a fixed epsilon, so that scenes of any scale and at any place look alike (docs/model/visibility.md).
glm::vec3 offset_origin(const SurfacePoint& point, glm::vec3 direction);

/// Where shadow rays leave a surface: on the smooth surface that its normals mean, off the one that rays meet.
inline glm::vec3 shadow_origin(const SurfacePoint& point) {
    return offset_origin(point, point.geometric_normal) + point.smooth.lift;
}

}  // namespace render2mpeg::renderer
