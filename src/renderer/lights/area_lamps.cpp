#include "renderer/lights/area_lamps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/lobe.h"
#include "renderer/lights/light_points.h"
#include "scene/pose/pose.h"

namespace render2mpeg::renderer {
namespace {

constexpr std::size_t most_outline_corners = 8;

/// Of a mesh's size: how far a corner may lie off the plane, or from the sphere.
constexpr float shape_error = 1e-3f;

/// Fewer triangles are a body with corners, not a sphere.
constexpr std::size_t least_sphere_triangles = 200;

/// Suns whose half angle is less throw shadows that are too sharp to be interpolated. chosen: 1 degree.
constexpr float sharp_sun = 0.01745f;

/// A lamp of less than this share of the power of all surfaces keeps its light points. chosen: an eighth; at a
/// sixty-fourth many_lamps took 14 % more rays, since clusters of many lamps are cheaper than each by itself.
constexpr double least_share = 1.0 / 8;

/// Edges that belong to one triangle alone: for each corner where the outline goes from there.
std::map<std::uint32_t, std::uint32_t> outline_of(const scene::Mesh& mesh, const std::vector<std::uint32_t>& welded,
                                                  bool& simple) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const glm::uvec3 t : mesh.triangles)
        for (int k = 0; k < 3; ++k) ++edges[{welded[t[k]], welded[t[(k + 1) % 3]]}];
    std::map<std::uint32_t, std::uint32_t> next;
    simple = true;
    for (const auto& [edge, count] : edges) {
        if (count > 1) simple = false;
        if (edges.contains({edge.second, edge.first})) continue;
        if (!next.emplace(edge.first, edge.second).second) simple = false;
    }
    return next;
}

glm::vec3 wound_normal(const scene::Mesh& mesh, glm::uvec3 t) {
    const glm::vec3 a = mesh.positions[t.x];
    return glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
}

bool is_flat(const scene::Mesh& mesh, glm::vec3 normal, float size) {
    for (const glm::uvec3 t : mesh.triangles) {
        if (!(glm::dot(wound_normal(mesh, t), normal) > 0)) return false;
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 off = mesh.positions[t[k]] - mesh.positions[mesh.triangles.front().x];
            if (std::abs(glm::dot(off, normal)) > 0.01f * shape_error * size) return false;
        }
    }
    return true;
}

float size_of(const scene::Mesh& mesh) {
    glm::vec3 low(mesh.positions.front()), high(low);
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    return glm::length(high - low);
}

/// Whether a matrix scales alike along all axes, and shears nothing.
bool scales_evenly(const glm::dmat3& m) {
    const glm::dmat3 squares = glm::transpose(m) * m;
    const double mean = (squares[0][0] + squares[1][1] + squares[2][2]) / 3;
    double off = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) off = std::max(off, std::abs(squares[c][r] - (c == r ? mean : 0)));
    return mean > 0 && off <= 2 * shape_error * mean;
}

/// By how much a matrix multiplies areas, about; exact where it scales evenly.
double area_scale(const glm::dmat3& m) {
    return std::pow(std::abs(glm::determinant(m)), 2.0 / 3);
}

/// How an object lies in all instants in which it is there.
struct Poses {
    bool round = true;   ///< scaled evenly in all of them
    double largest = 0;  ///< area_scale
};

/// Instants of a film that are looked at: so many, evenly, and about so many keys of scales and of what shows. chosen:
/// 64, and 1,024, since some films have a key in every frame.
constexpr int film_instants = 64;
constexpr std::size_t most_keys = 1024;

std::vector<double> instants_of(const scene::Animation& film) {
    std::vector<double> keys;
    for (const scene::Track& track : film.tracks)
        if (track.target == scene::TrackTarget::scale || track.target == scene::TrackTarget::visibility)
            keys.insert(keys.end(), track.times.begin(), track.times.end());
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    std::vector<double> instants;
    const std::size_t step = keys.size() / most_keys + 1;
    for (std::size_t i = 0; i < keys.size(); i += step) instants.push_back(keys[i]);
    for (int i = 0; i < film_instants; ++i) instants.push_back(film.duration * (i + 0.5) / film_instants);
    return instants;
}

/// Of these objects, over the whole film. Where they are hidden, they lie nowhere.
std::map<std::uint32_t, Poses> poses_of(const scene::Animation& film, const std::vector<std::uint32_t>& objects) {
    const bool moves = std::any_of(objects.begin(), objects.end(), [&](std::uint32_t object) {
        return film.objects[object].mobility != scene::Mobility::still;
    });
    std::map<std::uint32_t, Poses> poses;
    for (const double instant : moves ? instants_of(film) : std::vector<double>{0}) {
        const scene::Pose pose = scene::pose_at(film, instant);
        for (const std::uint32_t object : objects) {
            const int node = film.objects[object].node;
            const glm::dmat3 m(pose.world_of(node));
            Poses& p = poses[object];
            if ((moves && !pose.is_visible(node)) || !scene::normal_matrix(m).finite) continue;
            p.round = p.round && scales_evenly(m);
            p.largest = std::max(p.largest, area_scale(m));
        }
    }
    return poses;
}

/// The same radiance everywhere and in all directions, from places that no texture makes holes in. Alpha alone hides
/// the lamp, not its light.
bool shines_evenly(const scene::Animation& film, std::uint32_t object) {
    const scene::Object& o = film.objects[object];
    const scene::Material& material = film.materials[static_cast<std::size_t>(o.material)];
    return o.mobility != scene::Mobility::deforming && !material.emission_texture.present() && !material.unlit &&
           (material.alpha_mode == scene::AlphaMode::opaque ||
            (material.alpha_mode == scene::AlphaMode::blend && !material.base_color_texture.present() &&
             !material.alpha_texture.present()));
}

/// Solid angle of a triangle as seen from `centre` [VanOosterom1983].
double solid_angle(const scene::Mesh& mesh, glm::uvec3 t, glm::vec3 centre) {
    const glm::dvec3 a(mesh.positions[t.x] - centre), b(mesh.positions[t.y] - centre), c(mesh.positions[t.z] - centre);
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

/// Whether a mesh is one sphere, whole and once.
bool find_sphere(const scene::Mesh& mesh, glm::vec3& centre, float& radius, float& outer) {
    if (mesh.triangles.size() < least_sphere_triangles) return false;
    glm::vec3 low(mesh.positions.front()), high(low);
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    centre = 0.5f * (low + high);
    double area = 0, spanned = 0;
    float nearest = glm::length(high - low);
    outer = 0;
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::vec3 normal = wound_normal(mesh, t);
        if (!(glm::dot(normal, mesh.positions[t.x] - centre) > 0)) return false;
        area += 0.5 * glm::length(normal);
        spanned += solid_angle(mesh, t, centre);
        for (int k = 0; k < 3; ++k) {
            const float r = glm::length(mesh.positions[t[k]] - centre);
            nearest = std::min(nearest, r);
            outer = std::max(outer, r);
        }
    }
    radius = static_cast<float>(std::sqrt(area / (4 * std::numbers::pi)));
    return outer - nearest <= shape_error * outer && radius > 0.98f * outer && radius <= outer &&
           std::abs(spanned - 4 * std::numbers::pi) < 1e-4 * 4 * std::numbers::pi;
}

}  // namespace

std::vector<glm::vec3> convex_outline(const scene::Mesh& mesh) {
    if (mesh.triangles.empty() || mesh.triangles.size() > 4096) return {};
    const float size = size_of(mesh);
    const glm::vec3 normal = core::normalize_or(wound_normal(mesh, mesh.triangles.front()), glm::vec3(0));
    if (normal == glm::vec3(0) || !is_flat(mesh, normal, size)) return {};
    const std::vector<std::uint32_t> welded = scene::weld(mesh);
    bool simple = true;
    const auto next = outline_of(mesh, welded, simple);
    if (!simple || next.empty()) return {};
    // One loop, which takes in all open edges.
    std::vector<glm::vec3> loop;
    std::uint32_t at = next.begin()->first;
    do {
        loop.push_back(mesh.positions[at]);
        const auto found = next.find(at);
        if (found == next.end()) return {};
        at = found->second;
    } while (at != next.begin()->first && loop.size() <= next.size());
    if (loop.size() != next.size()) return {};
    // Corners turn left; points on a straight edge are none.
    std::vector<glm::vec3> corners;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const glm::vec3 in = loop[i] - loop[(i + loop.size() - 1) % loop.size()],
                        out = loop[(i + 1) % loop.size()] - loop[i];
        const float turn = glm::dot(glm::cross(in, out), normal), straight = 1e-4f * glm::length(in) * glm::length(out);
        if (turn < -straight) return {};
        if (turn > straight) corners.push_back(loop[i]);
    }
    return corners.size() >= 3 && corners.size() <= most_outline_corners ? corners : std::vector<glm::vec3>{};
}

AreaLamps::AreaLamps(const PosedScene& posed_scene, std::span<const LightPoint> points) {
    const scene::Animation& film = posed_scene.animation();
    std::map<std::uint32_t, double> power;
    for (const LightPoint& p : points) {
        if (p.kind == LightPointKind::directional && p.id >= first_punctual_id && p.disc2 > 0.0f) suns_.push_back(p.id);
        if (p.kind == LightPointKind::oriented) power[p.object] += core::luminance(p.intensity);
    }
    std::sort(suns_.begin(), suns_.end());

    // The points show things as large as they are now. What counts is how large they ever are.
    std::vector<std::uint32_t> objects;
    for (const auto& [object, own] : power)
        if (film.objects[object].mobility != scene::Mobility::deforming) objects.push_back(object);
    const std::map<std::uint32_t, Poses> poses = poses_of(film, objects);
    double all = 0;
    for (auto& [object, own] : power) {
        const auto found = poses.find(object);
        const double now = area_scale(glm::dmat3(posed_scene.posed().objects[object].to_world));
        if (found != poses.end()) own *= core::divide_or(found->second.largest, now, 1.0);
        all += own;
    }
    for (const auto& [object, own] : power) {
        Surface surface;
        if (!(own >= least_share * all) || !shines_evenly(film, object)) continue;
        const scene::Object& o = film.objects[object];
        const scene::Mesh& mesh = film.meshes[static_cast<std::size_t>(o.mesh)];
        surface.object = object;
        surface.corners = convex_outline(mesh);
        // Within a sphere that shines to both sides nothing is hidden from it: no lamp with an outline.
        const bool one_sided = !film.materials[static_cast<std::size_t>(o.material)].double_sided;
        if (!surface.corners.empty() ||
            (one_sided && poses.at(object).round && find_sphere(mesh, surface.centre, surface.radius, surface.outer)))
            surfaces_.push_back(std::move(surface));
    }
}

std::vector<LightPoint> AreaLamps::without(std::vector<LightPoint> points) const {
    if (surfaces_.empty() && suns_.empty()) return points;
    std::erase_if(points, [&](const LightPoint& p) {
        const auto is_its = [&](const Surface& s) { return s.object == p.object; };
        return (p.kind == LightPointKind::oriented && std::any_of(surfaces_.begin(), surfaces_.end(), is_its)) ||
               std::binary_search(suns_.begin(), suns_.end(), p.id);
    });
    return points;
}

AreaLamp AreaLamps::lamp_of(const PosedScene& posed_scene, const Surface& surface) const {
    const scene::Snapshot& now = posed_scene.posed();
    const glm::mat4& to_world = now.objects[surface.object].to_world;
    const auto placed = [&](glm::vec3 p) { return glm::vec3(to_world * glm::vec4(p, 1)); };
    AreaLamp lamp;
    lamp.object = surface.object;
    lamp.radiance = posed_scene.mean_emission(surface.object, 0);
    lamp.normal = posed_scene.front_normal(surface.object, 0);
    const SurfacePoint point = posed_scene.surface_at({surface.object, 0, 1.0f / 3, 1.0f / 3}, lamp.normal);
    lamp.clearance = 2 * point.position_error;
    if (!surface.corners.empty()) {
        const scene::Animation& film = posed_scene.animation();
        const auto material = static_cast<std::size_t>(film.objects[surface.object].material);
        lamp.two_sided = film.materials[material].double_sided;
        for (const glm::vec3& corner : surface.corners) lamp.corners.push_back(placed(corner));
        glm::vec3 across(0);
        for (std::size_t i = 2; i < lamp.corners.size(); ++i)
            across += glm::cross(lamp.corners[i - 1] - lamp.corners[0], lamp.corners[i] - lamp.corners[0]);
        lamp.area = 0.5f * glm::length(across);
        return lamp;
    }
    lamp.kind = AreaLamp::Kind::sphere;
    lamp.position = placed(surface.centre);
    const float scale = std::cbrt(std::abs(glm::determinant(glm::mat3(to_world))));
    lamp.radius = scale * surface.radius;
    lamp.clearance += scale * (1 + shape_error) * surface.outer - lamp.radius;
    lamp.area = 4 * std::numbers::pi_v<float> * lamp.radius * lamp.radius;
    return lamp;
}

std::vector<AreaLamp> AreaLamps::at(const PosedScene& posed_scene) const {
    const scene::Snapshot& now = posed_scene.posed();
    const auto shines = [](const AreaLamp& lamp) {
        return core::is_finite(lamp.radiance) && core::luminance(lamp.radiance) > 0.0f;
    };
    std::vector<AreaLamp> lamps;
    for (const scene::LightState& light : now.lights) {
        if (!std::binary_search(suns_.begin(), suns_.end(), first_punctual_id + light.id)) continue;
        AreaLamp lamp;
        lamp.kind = AreaLamp::Kind::sun;
        lamp.object = core::no_id;
        lamp.position = -light.direction;
        lamp.radius = std::sin(light.angle);
        lamp.sharp = light.angle < sharp_sun;
        lamp.radiance = light.intensity * (lobe::inverse_pi / (lamp.radius * lamp.radius));
        if (shines(lamp)) lamps.push_back(lamp);
    }
    for (const Surface& surface : surfaces_) {
        if (!now.objects[surface.object].present) continue;
        AreaLamp lamp = lamp_of(posed_scene, surface);
        if (shines(lamp) && lamp.area > 0 && std::isfinite(lamp.area)) lamps.push_back(std::move(lamp));
    }
    return lamps;
}

}  // namespace render2mpeg::renderer
