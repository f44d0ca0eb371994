#include "renderer/view/edited_mirror.h"

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

glm::dvec3 reflected(glm::dvec3 direction, glm::dvec3 normal) {
    return direction - 2.0 * glm::dot(direction, normal) * normal;
}

}  // namespace

bool has_aimed_reflection(const PosedScene& posed_scene, const SurfacePoint& point) {
    return posed_scene.posed().bends->edits(point.address.object) && !point.bounds_body;
}

void aim_reflection(const PosedScene& posed_scene, float time, SurfacePoint& point) {
    if (!has_aimed_reflection(posed_scene, point)) return;
    const glm::dvec3 n(point.shading_normal), mirrored = reflected(-glm::dvec3(point.outgoing), n);
    const glm::dvec3 aimed = posed_scene.posed().bends->bent(point.address.object, point.back_side,
                                                             glm::dvec3(point.position), n, mirrored, time);
    if (aimed != mirrored) point.outgoing = core::normalize_or(glm::vec3(-reflected(aimed, n)), point.outgoing);
}

SurfaceFootprint aimed_change(const PosedScene& posed_scene, const MirroredRay& ray, const SurfacePoint& point) {
    const auto aimed = [&](glm::vec3 spread, glm::vec3 footprint, glm::vec3 turn) {
        const glm::dvec3 n = glm::normalize(glm::dvec3(point.shading_normal) + glm::dvec3(turn)),
                         d = glm::normalize(glm::dvec3(ray.direction) + glm::dvec3(spread));
        return posed_scene.posed().bends->bent(point.address.object, point.back_side,
                                               glm::dvec3(point.position) + glm::dvec3(footprint), n, reflected(d, n),
                                               ray.time);
    };
    const glm::vec3 none{0.0f};
    const glm::dvec3 own = aimed(none, none, none);
    return {glm::vec3(aimed(ray.spread.dx, ray.footprint.dx, ray.turn.dx) - own),
            glm::vec3(aimed(ray.spread.dy, ray.footprint.dy, ray.turn.dy) - own)};
}

}  // namespace render2mpeg::renderer
