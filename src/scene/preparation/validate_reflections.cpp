// Checks edits of reflections.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "scene/model/wording.h"
#include "scene/pose/bent_reflections.h"
#include "scene/pose/pose.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/traits.h"
#include "scene/preparation/validate.h"

namespace render2mpeg::scene {
namespace {

/// Distance within which points coincide, over the size of the scene. chosen: a millionth.
constexpr double same_point = 1e-6;

std::string few_digits(double value) {
    std::ostringstream out;
    out.precision(3);
    out << value;
    return out.str();
}

}  // namespace

void validate_reflections(const Animation& animation, core::Rational first) {
    const std::vector<Reflection>& edits = animation.reflections;
    if (edits.empty()) return;
    const auto name_of = [&](std::size_t k) {
        return "reflection " + std::to_string(k) + " of " +
               in_quotes(animation.nodes[static_cast<std::size_t>(edits[k].mirror)].name);
    };
    for (std::size_t k = 0; k < edits.size(); ++k)
        if (std::none_of(animation.objects.begin(), animation.objects.end(), [&](const Object& object) {
                return object.node == edits[k].mirror && mirrors(animation, object);
            }))
            refuse(animation, name_of(k), "nothing there has a surface that mirrors");

    // As all stands when the film begins; what is hidden then is not looked at.
    const Pose pose = pose_at(animation, first.value());
    const Snapshot world = snapshot_at(animation, 0, first, {16, 16, 1});
    const double same = same_point * glm::length(glm::dvec3(animation.bounds_max - animation.bounds_min));
    std::vector<std::optional<AimedPoint>> points;
    for (std::size_t k = 0; k < edits.size(); ++k) {
        const auto& point = points.emplace_back(aimed_point(edits[k], world, pose));
        if (!point) continue;
        const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(pose.world_of(edits[k].mirror))))),
                     radius = scale * static_cast<double>(pose.reflection_radius[k]);
        if (point->off > radius)
            refuse(animation, name_of(k),
                   "its point lies " + few_digits(point->off) + " from the surface, farther than its radius of " +
                       few_digits(radius));
        const glm::dvec3 seen = glm::dvec3(pose.world_of(edits[k].see)[3]) - animation.origin;
        if (!(glm::length(seen - point->place) > same))
            refuse(animation, name_of(k), "what is to be seen lies on the point of the mirror itself");
        for (std::size_t j = 0; j < k; ++j)
            if (edits[j].mirror == edits[k].mirror && points[j] &&
                !(glm::length(points[j]->place - point->place) > same))
                refuse(animation, name_of(k), "its point is that of reflection " + std::to_string(j));
    }
}

}  // namespace render2mpeg::scene
