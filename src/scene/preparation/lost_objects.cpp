#include "scene/preparation/lost_objects.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <string>
#include <vector>

#include "core/text.h"
#include "scene/model/wording.h"
#include "scene/pose/extent.h"
#include "scene/pose/pose.h"

namespace render2mpeg::scene {
namespace {

/// Distance between neighbouring numbers in single precision.
double step_at(double coordinate) {
    const auto x = static_cast<float>(std::abs(coordinate));
    return static_cast<double>(std::nextafter(x, std::numeric_limits<float>::infinity())) - static_cast<double>(x);
}

/// chosen: a size of 8 steps, at which corners lie off by a sixteenth of it; a box of half a step is not met by any
/// ray.
constexpr double least_steps = 8;

/// Whether an object's place is too rough for its size.
bool is_rounded_away(const Animation& animation, const Object& object, const glm::dmat4& to_world) {
    const glm::dvec3 place = glm::dvec3(to_world[3]) - animation.origin;
    const double step = step_at(std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}));
    // A look at all vertices is for those that are far away.
    const double scale = std::max({glm::length(to_world[0]), glm::length(to_world[1]), glm::length(to_world[2])});
    if (step < 1e-4 * scale) return false;
    constexpr double none = std::numeric_limits<double>::infinity();
    Extent extent{glm::dvec3(none), glm::dvec3(-none)};
    for (const glm::vec3& p : animation.meshes[static_cast<std::size_t>(object.mesh)].positions)
        extent.hold(to_world * glm::dvec4(p, 0));
    return 2 * extent.radius() < least_steps * step;
}

void note(Animation& animation, const std::vector<std::size_t>& lost, const std::string& why) {
    if (lost.empty()) return;
    const std::string others = lost.size() > 1 ? " and " + core::counted(lost.size() - 1, "other") : "";
    note_once(animation, described("object", lost[0], animation.objects[lost[0]].name) + others + ": " + why);
}

}  // namespace

void note_lost_objects(Animation& animation, double start) {
    constexpr int instants = 5;
    std::vector<char> has_size(animation.objects.size(), 0), has_place(animation.objects.size(), 0);
    for (int k = 0; k < instants; ++k) {
        const Pose pose = pose_at(animation, start + animation.duration * k / (instants - 1));
        for (std::size_t i = 0; i < animation.objects.size(); ++i) {
            const Object& object = animation.objects[i];
            const glm::dmat4 to_world = pose.world_of(object.node);
            // A skin places its vertices by itself.
            if (object.skin >= 0 || normal_matrix(glm::dmat3(to_world)).finite) has_size[i] = 1;
            if (object.skin >= 0 || !is_rounded_away(animation, object, to_world)) has_place[i] = 1;
        }
        if (animation.duration == 0) break;
    }
    std::vector<std::size_t> flat, rounded;
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        if (has_size[i] == 0) flat.push_back(i);
        if (has_size[i] != 0 && has_place[i] == 0) rounded.push_back(i);
    }
    note(animation, flat, "a scale of 0 leaves nothing to be seen; a very small one shows a disc");
    note(animation, rounded,
         "too far from the rest for its size, where single precision has no places between: it is not seen as it is");
}

}  // namespace render2mpeg::scene
