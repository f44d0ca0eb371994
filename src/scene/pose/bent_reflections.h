#pragma once
// Mirrors that are told what to show. [Ritschel2009b] turns each mirrored ray by a rotation that is interpolated over
// the surface between constraints, and fades it at the borders of regions. Here a constraint's rotation is the smallest
// one, and rotation vectors are mixed instead of matrices made orthogonal (eqs. 7.5 and 7.7 of Ritschel's
// dissertation): nothing is singular for one or two constraints. Constraints hold for each frame's own eye, so that
// they stay true while all moves; and regions grow until no border folds (docs/model/reflections.md).
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "core/surface_address.h"
#include "scene/model/animation.h"
#include "scene/model/shutter.h"

namespace render2mpeg::scene {

struct Snapshot;
struct Pose;

/// One edit at one instant, in world space.
struct Bend {
    glm::dvec3 at{0};       ///< the point on the mirror
    glm::dvec3 turn{0};     ///< rotation vector, radians: takes the ray that the eye sees mirrored there to its target
    double radius = 0;      ///< whole turn within
    double fade = 0;        ///< one over the border's width; 0: it never ends
    double everywhere = 0;  ///< 0..1, share of the turn that the mirror has outside, where all of it would fold
    double strength = 0;    ///< 0..1; below 1 where the point is seen edge-on, or its target has come to it
};

/// All edits of a film while one frame's shutter is open.
class BentReflections {
  public:
    /// Whether an object's reflections are edited.
    bool edits(std::uint32_t object) const { return !of_object_[object].empty(); }

    /// Where a ray goes on whose law of reflection says `mirrored`. `place`: world; `normal`: unit, on the side it came
    /// from; `back_side`: of the winding; `time`: of the shutter (Sweep). Returns `mirrored` itself where no edit
    /// reaches; else a unit direction that is not below the surface.
    glm::dvec3 bent(std::uint32_t object, bool back_side, glm::dvec3 place, glm::dvec3 normal, glm::dvec3 mirrored,
                    float time) const;

    /// Edits as the middle of the shutter has them, by their order in the film.
    const std::vector<Bend>& middle() const { return knots_[knots_.size() / 2]; }

  private:
    friend std::shared_ptr<const BentReflections> bend_reflections(const Snapshot&, const Pose&, int,
                                                                   const ShutterInterval&);
    Bend at(std::size_t edit, float time) const;

    std::vector<std::vector<std::size_t>> of_object_;  ///< edits of each object
    std::vector<std::vector<Bend>> knots_;             ///< evenly over the shutter's time: one, or three
    std::vector<bool> back_;                           ///< of each edit: its point is seen from behind
};

/// The edits of a posed snapshot, whose sweep is found already; null where the film has none.
std::shared_ptr<const BentReflections> bend_reflections(const Snapshot& snapshot, const Pose& pose, int camera,
                                                        const ShutterInterval& shutter);

/// The point of a mirror's surface that an edit means, and how far from it its node stands; none where nothing of the
/// mirror is there.
struct AimedPoint {
    core::SurfaceAddress address;
    glm::dvec3 place{0};  ///< world
    double off = 0;
};
std::optional<AimedPoint> aimed_point(const Reflection& edit, const Snapshot& snapshot, const Pose& pose);

/// Where an edited mirror shows a point (world), near to the place `near` of its surface; none where that is not found.
std::optional<glm::dvec3> shown_at(glm::dvec3 point, const core::SurfaceAddress& near, const Snapshot& world);

}  // namespace render2mpeg::scene
