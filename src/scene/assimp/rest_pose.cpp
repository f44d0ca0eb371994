#include "scene/assimp/rest_pose.h"

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::scene {
namespace {

glm::dmat4 local_transform(const Node& node) {
    if (node.matrix) return *node.matrix;
    return glm::translate(glm::dmat4(1), node.translation) * glm::mat4_cast(node.rotation) *
           glm::scale(glm::dmat4(1), node.scale);
}

/// Whether the geometry tells which side is the front.
bool front_is_plain(const Mesh& mesh, const glm::dmat4& to_world, glm::dvec3 middle) {
    glm::dvec3 vector_area{0};
    double area = 0, volume = 0, towards_middle = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const auto corner = [&](unsigned i) { return glm::dvec3(to_world * glm::dvec4(mesh.positions[i], 1)); };
        const glm::dvec3 a = corner(t.x), b = corner(t.y), c = corner(t.z);
        const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
        vector_area += normal;
        area += glm::length(normal);
        volume += glm::dot(a - middle, normal) / 3.0;
        towards_middle += glm::dot(middle - (a + b + c) / 3.0, normal);
    }
    // The vector area of a closed surface is 0. chosen: 5 % of the area for meshes with small holes; a hemisphere has
    // 50 %.
    if (glm::length(vector_area) < 0.05 * area) return volume > 0;
    return towards_middle > 0;
}

}  // namespace

glm::dquat upright(SignedAxis right, SignedAxis up, SignedAxis front) {
    const auto vector = [](SignedAxis a) {
        glm::dvec3 v{0};
        if (a.axis >= 0 && a.axis < 3) v[a.axis] = a.sign < 0 ? -1 : 1;
        return v;
    };
    // Columns are our axes in the file; the inverse takes the file's to ours.
    const glm::dmat3 ours(vector(right), vector(up), vector(front));
    if (glm::determinant(ours) > 0.5) return glm::normalize(glm::quat_cast(glm::transpose(ours)));
    const glm::dvec3 u = vector(up);
    if (glm::length(u) < 0.5 || u.y > 0.5) return {1, 0, 0, 0};
    if (u.y < -0.5) return {0, 1, 0, 0};  // half a turn about x
    return glm::angleAxis(glm::half_pi<double>(), glm::cross(u, glm::dvec3(0, 1, 0)));
}

std::vector<glm::dmat4> rest_transforms(const Animation& animation) {
    std::vector<glm::dmat4> to_world(animation.nodes.size());
    for (std::size_t i = 0; i < animation.nodes.size(); ++i) {
        const Node& node = animation.nodes[i];
        EXPECTS(node.parent < static_cast<int>(i));
        to_world[i] = local_transform(node);
        if (node.parent >= 0) to_world[i] = to_world[static_cast<std::size_t>(node.parent)] * to_world[i];
    }
    return to_world;
}

RestBounds rest_bounds(const Animation& animation, const std::vector<glm::dmat4>& to_world) {
    constexpr double far = std::numeric_limits<double>::max();
    RestBounds bounds{glm::dvec3(far), glm::dvec3(-far)};
    for (const Object& object : animation.objects) {
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        const glm::dmat4& m = to_world[static_cast<std::size_t>(object.node)];
        for (const glm::vec3 p : mesh.positions) {
            const glm::dvec3 world(m * glm::dvec4(p, 1));
            if (!core::is_finite(glm::vec3(world))) continue;
            bounds.min = glm::min(bounds.min, world);
            bounds.max = glm::max(bounds.max, world);
        }
    }
    if (bounds.min.x > bounds.max.x) return {};
    return bounds;
}

void settle_sides_of_lamps(Animation& animation, const std::vector<glm::dmat4>& to_world, const RestBounds& bounds) {
    std::vector<char> plain(animation.materials.size(), 1);
    for (const Object& object : animation.objects) {
        const auto material = static_cast<std::size_t>(object.material);
        if (!animation.materials[material].emits()) continue;
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        const bool rigid = object.skin < 0;
        if (!rigid || !front_is_plain(mesh, to_world[static_cast<std::size_t>(object.node)], bounds.center()))
            plain[material] = 0;
    }
    for (std::size_t i = 0; i < plain.size(); ++i)
        if (animation.materials[i].emits()) animation.materials[i].double_sided = !plain[i];
}

}  // namespace render2mpeg::scene
