#pragma once
// What can only be said of a whole Assimp scene before anything moves.
#include <glm/glm.hpp>
#include <vector>

#include "scene/model/animation.h"

/// What can only be said of a whole scene as it stands before anything moves: needed where a format leaves open what a
/// physical renderer must know.
namespace render2mpeg::scene {

/// Gives corners without a usable normal that of one of their triangles, and every normal unit length: importers leave
/// "not a number" or 0 where they found no area.
void mend_normals(Mesh& mesh);

/// An axis of a file: 0, 1, 2 for x, y, z, and -1 or 1 for its direction.
struct SignedAxis {
    int axis = 0;
    int sign = 1;
};

/// The turn that takes a file's axes to ours: `right` to +x, `up` to +y, `front` (towards the viewer) to +z. Where the
/// three make no right-handed frame, the shortest turn that takes `up` to +y.
glm::dquat upright(SignedAxis right, SignedAxis up, SignedAxis front);

/// World transform of every node at rest. Parents must come before their children.
std::vector<glm::dmat4> rest_transforms(const Animation& animation);

struct RestBounds {
    glm::dvec3 min{0}, max{0};  ///< equal where there is no surface
    glm::dvec3 center() const { return 0.5 * (min + max); }
    double diagonal() const { return glm::length(max - min); }
};

/// A box about all finite vertices.
RestBounds rest_bounds(const Animation& animation, const std::vector<glm::dmat4>& to_world);

/// Lamps shine from one side where that side is plain: closed meshes outwards, open ones if their front faces the
/// scene's middle. Others stay two-sided, since no light at all is worse than half of it lost.
void settle_sides_of_lamps(Animation& animation, const std::vector<glm::dmat4>& to_world, const RestBounds& bounds);

}  // namespace render2mpeg::scene
