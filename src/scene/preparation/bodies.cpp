// Where light goes straight through glass, nothing gathers it: next events find it, and no photon is needed. That is
// so of shapes whose faces are parallel, part by part, whatever else is in the mesh.
#include "scene/preparation/bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "core/numeric.h"
#include "scene/model/wording.h"
#include "scene/pose/extent.h"
#include "scene/pose/pose.h"

namespace render2mpeg::scene {
namespace {

/// chosen: 5 %, as of lamps that shine outwards (docs/model/materials.md); a bottle without its bottom is at 10 %.
constexpr double closed = 0.05;

/// Largest thickness of a pane over the root of its area. chosen: a twentieth: light at 45 degrees is moved aside by a
/// third of the thickness, so by 1.6 % of the pane's width.
constexpr double most_thickness = 0.05;

/// Least share of a pane's area that lies in its two faces. chosen: 0.9; the rim of a square of that thickness is 9 %.
constexpr double least_in_faces = 0.9;

/// Cosine to which the faces are parallel. chosen: half a degree, so that what is bent by them meets no nearer than 57
/// times the pane's width.
constexpr double parallel_cosine = 0.999962;

/// Least share of a mesh's area in panes: all but crumbs. chosen: 0.99.
constexpr double least_in_panes = 0.99;

bool bounds_glass(const Material& m) {
    const bool all_metal = m.metallic >= 1 && !m.metallic_roughness_texture.present();
    return m.thickness != Thickness::thin && m.transmission > 0 && !m.unlit && !m.specular_glossiness && !all_metal;
}

using Positions = std::vector<glm::dvec3>;

glm::dvec3 vector_area(const auto& positions, glm::uvec3 t) {
    const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
    return 0.5 * glm::cross(b - a, c - a);
}

/// Triangles of each part of a mesh that hangs together, one part after the other.
std::vector<std::vector<glm::uvec3>> parts_of(const Mesh& mesh) {
    std::vector<std::uint32_t> up = weld(mesh);
    const auto root = [&](std::uint32_t i) {
        while (up[i] != i) i = up[i] = up[up[i]];
        return i;
    };
    for (const glm::uvec3& t : mesh.triangles)
        for (int k = 1; k < 3; ++k) up[root(t[k])] = root(t[0]);
    std::map<std::uint32_t, std::vector<glm::uvec3>> parts;
    for (const glm::uvec3& t : mesh.triangles) parts[root(t.x)].push_back(t);
    std::vector<std::vector<glm::uvec3>> result;
    for (auto& [first, triangles] : parts) result.push_back(std::move(triangles));
    return result;
}

/// Sums over panes.
struct Panes {
    double area = 0;  ///< of all of the mesh
    double in_panes = 0, in_faces = 0;
    double volume = 0;
};

void add_part(const Positions& positions, const std::vector<glm::uvec3>& part, Panes& panes) {
    glm::dvec3 largest(0);
    double area = 0, six_volumes = 0;
    const glm::dvec3 origin = positions[part.front().x];
    for (const glm::uvec3& t : part) {
        const glm::dvec3 a = vector_area(positions, t);
        area += glm::length(a);
        six_volumes += 2.0 * glm::dot(positions[t.x] - origin, a);
        if (glm::length(a) > glm::length(largest)) largest = a;
    }
    panes.area += area;
    if (!(glm::length(largest) > 0.0)) return;
    const glm::dvec3 normal = glm::normalize(largest);
    double faces = 0, low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const glm::uvec3& t : part) {
        const glm::dvec3 a = vector_area(positions, t);
        if (std::abs(glm::dot(a, normal)) >= parallel_cosine * glm::length(a)) faces += glm::length(a);
        for (int k = 0; k < 3; ++k) {
            const double along = glm::dot(positions[t[k]] - origin, normal);
            low = std::min(low, along);
            high = std::max(high, along);
        }
    }
    if (faces < least_in_faces * area || high - low > most_thickness * std::sqrt(0.5 * faces)) return;
    panes.in_panes += area;
    panes.in_faces += faces;
    panes.volume += std::abs(six_volumes) / 6.0;
}

/// Mean thickness of an object's panes, world; none if it is something else at any instant.
std::optional<float> pane_thickness(const Animation& animation, const Object& object,
                                    const std::vector<std::vector<glm::uvec3>>& parts, const std::vector<Pose>& poses) {
    std::optional<float> thickness;
    for (std::size_t k = 0; k < (object.mobility == Mobility::still ? 1 : poses.size()); ++k) {
        const Positions positions = world_positions(animation, object, poses[k]);
        if (positions.empty()) continue;
        Panes panes;
        for (const std::vector<glm::uvec3>& part : parts) add_part(positions, part, panes);
        if (panes.in_panes < least_in_panes * panes.area) return {};
        if (!thickness) thickness = static_cast<float>(core::divide_or(2.0 * panes.volume, panes.in_faces, 0.0));
    }
    return thickness;
}

/// Whether triangles close a surface: their vector areas cancel out.
bool is_closed(const Mesh& mesh) {
    glm::dvec3 sum(0);
    double area = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 part = vector_area(mesh.positions, t);
        sum += part;
        area += glm::length(part);
    }
    return area > 0 && glm::length(sum) < closed * area;
}

}  // namespace

void set_bodies(Animation& animation, double start) {
    std::vector<Pose> poses;
    std::map<int, std::vector<std::vector<glm::uvec3>>> parts;
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        Object& object = animation.objects[i];
        const Material& material = animation.materials[static_cast<std::size_t>(object.material)];
        object.body = Body::none;
        if (!bounds_glass(material)) continue;
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        if (!is_closed(mesh)) {
            if (material.thickness == Thickness::solid_where_closed) continue;
            note_once(animation,
                      described("object", i, object.name) + ": is solid glass, but not closed; light may stay inside");
        }
        for (std::size_t k = poses.size(); k < 5; ++k)
            poses.push_back(pose_at(animation, std::lerp(start, animation.duration, 0.25 * static_cast<double>(k))));
        if (!parts.contains(object.mesh)) parts[object.mesh] = parts_of(mesh);
        const std::optional<float> pane = pane_thickness(animation, object, parts[object.mesh], poses);
        object.body = pane ? Body::slab : Body::solid;
        object.pane_thickness = pane.value_or(0.0f);
    }
}

}  // namespace render2mpeg::scene
