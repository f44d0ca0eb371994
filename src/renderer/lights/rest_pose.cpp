#include "renderer/lights/rest_pose.h"

#include <algorithm>
#include <cmath>

#include "core/box.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Most that a triangle of a deforming object may be thought to grow. chosen: 16, not tuned: a sliver
/// that opens would else claim a disc as large as the world, and all its light be clamped.
constexpr float most_growth = 16.0f;

float area_of(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    return 0.5f * glm::length(glm::cross(b - a, c - a));
}

/// Bound of a triangle's growth under an affine map.
float largest_scale(const glm::mat4& m) {
    float a = glm::length(glm::vec3(m[0])), b = glm::length(glm::vec3(m[1])), c = glm::length(glm::vec3(m[2]));
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    return 2.0f * a * b;
}

}  // namespace

const scene::Mesh& RestPoses::mesh_of(std::uint32_t object) const {
    return film_->meshes[static_cast<std::size_t>(film_->objects[object].mesh)];
}

OrientedPoint RestPoses::at(const core::SurfaceAddress& a, bool front) const {
    const scene::Mesh& mesh = mesh_of(a.object);
    const std::vector<glm::vec3>& positions = mesh.positions;
    if (mesh.has_curves()) return {glm::vec3(scene::interpolated(mesh, positions, a)), {0, 0, 1}};
    const glm::uvec3 t = mesh.triangles[a.primitive];
    const glm::vec3 p = positions[t.x], e1 = positions[t.y] - p, e2 = positions[t.z] - p;
    const glm::vec3 normal = core::normalize_or(glm::cross(e1, e2), {0, 0, 1});
    return {p + a.u * e1 + a.v * e2, front ? normal : -normal};
}

float RestPoses::area_scale(const scene::Snapshot& now, const core::SurfaceAddress& a) const {
    if (mesh_of(a.object).has_curves()) return 1.0f;
    const std::vector<glm::vec3>& positions = mesh_of(a.object).positions;
    const glm::uvec3 t = mesh_of(a.object).triangles[a.primitive];
    const scene::Triangle world = scene::triangle_of(now, a.object, a.primitive);
    const float scale = core::divide_or(area_of(world.a, world.b, world.c),
                                        area_of(positions[t.x], positions[t.y], positions[t.z]), 1.0f);
    const scene::ObjectState& state = now.objects[a.object];
    return std::min(scale, state.deformed >= 0 ? most_growth : largest_scale(state.to_world));
}

float RestPoses::extent2(std::uint32_t object) const {
    const std::vector<glm::vec3>& positions = mesh_of(object).positions;
    const auto box = core::Box::about(positions);
    const glm::vec3 size = positions.empty() ? glm::vec3(0) : box.size();
    return glm::dot(size, size);
}

}  // namespace render2mpeg::renderer
