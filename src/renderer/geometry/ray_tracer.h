#pragma once
// Traces rays through the posed scene, with Embree.
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/isa.h"
#include "core/surface_address.h"
#include "renderer/base/bodies.h"
#include "renderer/geometry/layer_limit.h"
#include "scene/pose/sweep.h"

namespace render2mpeg::renderer {

/// A ray and how far it goes, in units of the direction's length.
struct RayQuery {
    glm::vec3 origin{0}, direction{0, 0, -1};
    float far = 0;
    float time = scene::middle_time;  ///< of the shutter, 0..1
};

/// A ray's hit. The normal is that of the triangle as it is wound, not turned to the ray, not normalised.
struct Hit {
    core::SurfaceAddress address;  ///< no surface: the ray left the scene
    float distance = 0;            ///< in units of the direction's length
    glm::vec3 geometric_normal{0};
    bool found() const { return address.is_surface(); }
};

/// Up to 16 shadow rays from the points of a tile towards one light point: the shape that this machine traces fastest.
struct alignas(64) ShadowPacket {
    float origin_x[16], origin_y[16], origin_z[16];           ///< already moved off their surfaces (offset_origin)
    float direction_x[16], direction_y[16], direction_z[16];  ///< need not be unit
    float far[16];                                            ///< end of the ray in units of the direction's length
    std::uint32_t active = 0;      ///< bit i: ray i is asked for; the others' values do not matter
    const float* times = nullptr;  ///< of the shutter, of sixteen rays; null: all of its middle
    Bodies bodies = Bodies::pass;
};

/// The only class that knows Embree. Non-finite rays are answered as misses (Debian's Embree aborts on them); the scene
/// is built ROBUST. Answers are a function of what is posed, whatever was posed before and whatever the number of
/// threads.
class RayTracer {
  public:
    /// Share of light, per channel, that a surface lets through at a point met by a shadow or eye ray: 0 opaque, 1
    /// invisible. `direction`: the ray's, of any length. Called from many threads.
    using Transmittance = std::function<glm::vec3(const core::SurfaceAddress&, glm::vec3 direction, Bodies bodies)>;

    /// `translucent[m]`: surfaces of material m let some light through and are asked `transmittance`; all others are
    /// opaque. The animation is complete and outlives this. Throws core::Error where Embree cannot start or runs out of
    /// memory.
    RayTracer(const scene::Animation& animation, core::Isa isa, std::vector<bool> translucent,
              Transmittance transmittance);
    /// Another of the same animation, for other instants: it shares what never moves with `posed`, which was posed
    /// before. Each may be posed while rays are traced in the other.
    RayTracer(const RayTracer& posed, Transmittance transmittance);
    ~RayTracer();
    RayTracer(RayTracer&&) noexcept;

    /// Moves everything to where it is in the snapshot and while its shutter is open; cheap for what has not moved
    /// since the last call. Before the first call every ray misses. Not to be called while rays are traced.
    void pose(const scene::Snapshot& snapshot);

    /// The nearest surface at a distance in (0, far), translucent ones included. Of surfaces that lie in one plane
    /// (within 2^-19 of the distance) a front wins over a back, then the lowest object, then primitive, so that they do
    /// not flicker.
    /// `time`: of the shutter; all other questions are about its middle.
    Hit nearest(glm::vec3 origin, glm::vec3 direction, float far, float time = scene::middle_time) const;

    /// The same for many rays, as many as `hits`; for less than half of the price where sixteen in a row are
    /// neighbours.
    void nearest(std::span<const RayQuery> rays, std::span<Hit> hits) const;

    /// The same, but of surfaces that lie in one plane any may be found: for light that is a mean over many rays.
    /// `coherent`: sixteen in a row are neighbours.
    void any_nearest(std::span<const RayQuery> rays, std::span<Hit> hits, bool coherent) const;

    /// The nearest surface of an object below which light goes; all others are passed. Of those that lie in one plane
    /// any may be found.
    Hit nearest_of(std::uint32_t object, const RayQuery& ray) const;

    /// Whether the ray meets anything at a distance in (0, far), translucent or not: whether `nearest` finds something,
    /// for less.
    bool meets(glm::vec3 origin, glm::vec3 direction, float far) const;

    /// Whether some objects move, change their shape, come or go in the film.
    bool has_dynamic_objects() const;

    /// Whether the ray may meet such an object at a distance in (0, far): no false denial, and no ray is traced.
    bool may_meet_dynamic(glm::vec3 origin, glm::vec3 direction, float far) const;

    /// Bit i: ray i of the packet is blocked by something opaque. Translucent surfaces do not block; where the packet
    /// met any, `light` (16 values, if given) is multiplied by what passes (at most `max_layers` surfaces; beyond them:
    /// blocked).
    std::uint32_t occluded(const ShadowPacket& packet, glm::vec3* light) const;

    /// Transmittance of one ray, 0 where blocked.
    glm::vec3 passes(glm::vec3 origin, glm::vec3 direction, float far, Bodies bodies = Bodies::pass) const;

    /// Whether rays meet this object through a transform of its own, which costs some digits.
    bool is_instanced(std::uint32_t object) const;

    static constexpr int max_layers = 16;
    /// Of rays that go on from surface to surface.
    const LayerLimit& limit() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace render2mpeg::renderer
