#include "scene/pose/extent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/pose/pose.h"

namespace render2mpeg::scene {

namespace {

bool all_within_reach(const std::vector<glm::dvec3>& positions) {
    return std::all_of(positions.begin(), positions.end(), [](const glm::dvec3& p) {
        return std::abs(p.x) <= farthest && std::abs(p.y) <= farthest && std::abs(p.z) <= farthest;
    });
}

}  // namespace

std::vector<glm::dvec3> world_positions(const Animation& animation, const Object& object, const Pose& pose) {
    if (!pose.is_visible(object.node)) return {};
    if (object.mobility == Mobility::deforming) {
        std::vector<glm::dvec3> deformed = deformed_positions(animation, object, pose);
        return all_within_reach(deformed) ? deformed : std::vector<glm::dvec3>{};
    }
    const glm::dmat4 to_world = pose.world_of(object.node);
    if (!normal_matrix(glm::dmat3(to_world)).finite) return {};
    std::vector<glm::dvec3> positions;
    const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
    positions.reserve(mesh.positions.size());
    for (const glm::vec3& p : mesh.positions) positions.emplace_back(to_world * glm::dvec4(p, 1));
    return all_within_reach(positions) ? positions : std::vector<glm::dvec3>{};
}

std::vector<glm::dvec3> world_corners(const Volume& volume, const Pose& pose) {
    const glm::dmat4 to_world = pose.world_of(volume.node);
    if (!volume.outline.box.any() || !pose.is_visible(volume.node) || !normal_matrix(glm::dmat3(to_world)).finite)
        return {};
    std::vector<glm::dvec3> corners = volume.outline.box.corners();
    for (glm::dvec3& corner : corners) corner = to_world * glm::dvec4(corner, 1);
    return all_within_reach(corners) ? corners : std::vector<glm::dvec3>{};
}

std::optional<Extent> extent_at(const Animation& animation, double seconds) {
    const Pose pose = pose_at(animation, seconds);
    Extent extent{glm::dvec3(std::numeric_limits<double>::infinity()),
                  glm::dvec3(-std::numeric_limits<double>::infinity())};
    for (const Object& object : animation.objects) {
        const std::vector<glm::dvec3> positions = world_positions(animation, object, pose);
        if (positions.empty()) continue;
        // Unused vertices do not count.
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        if (mesh.has_curves())
            for (const glm::dvec3& p : positions) extent.hold(p);
        for (const glm::uvec3& t : mesh.triangles)
            for (int k = 0; k < 3; ++k) extent.hold(positions[t[k]]);
    }
    for (const Volume& volume : animation.volumes)
        for (const glm::dvec3& p : world_corners(volume, pose)) extent.hold(p);
    return extent.low.x <= extent.high.x ? std::optional(extent) : std::nullopt;
}

std::optional<Extent> extent_of_film(const Animation& animation) {
    std::optional<Extent> whole;
    for (int k = 0; k < 5; ++k) {
        const std::optional<Extent> now = extent_at(animation, animation.duration * k / 4);
        if (!now) continue;
        if (!whole) whole = now;
        whole->hold(now->low);
        whole->hold(now->high);
        if (animation.duration == 0) break;
    }
    return whole;
}

Extent detailed_extent_at(const Animation& animation, double seconds) {
    const Pose pose = pose_at(animation, seconds);
    std::vector<double> centres[3];
    for (const Object& object : animation.objects) {
        const std::vector<glm::dvec3> positions = world_positions(animation, object, pose);
        if (positions.empty()) continue;
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        for (const std::uint32_t first : mesh.curves)
            for (int k = 0; k < 3; ++k) centres[k].push_back(positions[first + 1][k]);
        for (const glm::uvec3& t : mesh.triangles)
            for (int k = 0; k < 3; ++k)
                centres[k].push_back((positions[t.x][k] + positions[t.y][k] + positions[t.z][k]) / 3);
    }
    Extent extent;
    for (int k = 0; k < 3; ++k) {
        std::vector<double>& c = centres[k];
        if (c.empty()) continue;
        const auto at = [&](std::size_t rank) {
            std::nth_element(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(rank), c.end());
            return c[rank];
        };
        extent.low[k] = at(c.size() / 100);
        extent.high[k] = at(c.size() - 1 - c.size() / 100);
    }
    return extent;
}

}  // namespace render2mpeg::scene
