#pragma once
// The surface of a mirror as edits of its reflections need it: places, normals, and how these turn.
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "core/surface_address.h"
#include "scene/pose/pose.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::scene {

/// Objects and eye at one instant.
struct Instant {
    const std::vector<ObjectState>& objects;
    const std::vector<DeformedMesh>& deformed;
    const Pose& pose;
    glm::dvec3 eye, forward;
    bool has_eye;  ///< or all ways go `forward`

    /// From the eye to a place.
    glm::dvec3 way_to(glm::dvec3 place) const { return has_eye ? place - eye : forward; }
};

/// A place of a surface and how it curves there.
struct Spot {
    glm::dvec3 place{0}, front{0}, normal{0};  ///< `front`: the triangle's own normal, `normal` the smooth one
    glm::dvec3 along[2]{},
        turn[2]{glm::dvec3(0), glm::dvec3(0)};  ///< two unit directions, and how the normal turns on the way along each
};

struct Corners {
    glm::dvec3 place[3], normal[3];
};

/// Corners of a triangle; normals are 0 where the mesh has none.
Corners corners_of(const Animation& animation, std::uint32_t object, std::uint32_t primitive, const ObjectState& state,
                   const std::vector<DeformedMesh>& deformed);

/// None where the triangle has no area.
std::optional<Spot> spot_at(const Animation& animation, const core::SurfaceAddress& address, const ObjectState& state,
                            const std::vector<DeformedMesh>& deformed);

/// Weights of the second and the third corner at the point of a triangle that is nearest to p.
glm::dvec2 nearest_weights(glm::dvec3 p, const glm::dvec3 (&corner)[3]);

/// Mirror reflection of an eye's ray at a place.
struct MirroredRay {
    glm::dvec3 mirrored{0};
    double cosine = 0;  ///< to the normal
};
MirroredRay ray_at(const Instant& now, glm::dvec3 place, glm::dvec3 n);

/// A mirror about an edit's point as its first two derivatives have it, and what an eye sees in it.
struct LocalMirror {
    const Spot& spot;
    const Instant& now;
    double side;  ///< -1: it is seen from behind

    glm::dvec3 place(glm::dvec2 x) const {
        const glm::dvec3 over = x.x * spot.along[0] + x.y * spot.along[1];
        return spot.place + over - 0.5 * glm::dot(over, x.x * spot.turn[0] + x.y * spot.turn[1]) * spot.normal;
    }
    glm::dvec3 normal(glm::dvec2 x) const {
        return side * glm::normalize(spot.normal + x.x * spot.turn[0] + x.y * spot.turn[1]);
    }
    MirroredRay ray(glm::dvec2 x) const { return ray_at(now, place(x), normal(x)); }
};

}  // namespace render2mpeg::scene
