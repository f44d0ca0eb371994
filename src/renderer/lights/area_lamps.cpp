#include "renderer/lights/area_lamps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/lights/light.h"
#include "scene/pose/pose.h"

namespace render2mpeg::renderer {
namespace {

/// A lamp of less than this share of the power of all surfaces keeps its light points. chosen: an eighth; at a
/// sixty-fourth many_lamps took 14 % more rays, since clusters of many lamps are cheaper than each by itself.
constexpr double least_share = 1.0 / 8;

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
           material.curve_of(scene::AngledInput::emission) == nullptr &&
           material.curve_of(scene::AngledInput::alpha) == nullptr &&
           (material.alpha_mode == scene::AlphaMode::opaque ||
            (material.alpha_mode == scene::AlphaMode::blend && !material.base_color_texture.present() &&
             !material.alpha_texture.present()));
}

/// Whether it is that of a sun with a size.
bool is_of_sun(const LightPoint& p) {
    return p.is_far() && p.is_of_lamp() && p.disc2 > 0.0f;
}

}  // namespace

AreaLamps::AreaLamps(const PosedScene& posed_scene, std::span<const LightPoint> points)
    : suns_(std::any_of(points.begin(), points.end(), is_of_sun)) {
    const scene::Animation& film = posed_scene.animation();
    std::map<std::uint32_t, double> power;
    for (const LightPoint& p : points)
        if (p.is_of_surface()) power[p.object] += core::luminance(p.intensity);

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
        if (!(own >= least_share * all) || !shines_evenly(film, object)) continue;
        const scene::Object& o = film.objects[object];
        const bool two_sided = film.materials[static_cast<std::size_t>(o.material)].double_sided;
        for (const auto kind : lamp_shapes) {
            LampShape shape = kind(film.meshes[static_cast<std::size_t>(o.mesh)], two_sided, poses.at(object).round);
            if (shape) surfaces_.emplace(object, std::move(shape));
        }
    }
}

std::vector<LightPoint> AreaLamps::without(std::vector<LightPoint> points) const {
    std::erase_if(points, [&](const LightPoint& p) {
        return (p.is_of_surface() && surfaces_.contains(p.object)) || (suns_ && is_of_sun(p));
    });
    return points;
}

std::vector<std::shared_ptr<const AreaLamp>> AreaLamps::at(const PosedScene& posed_scene) const {
    const scene::Snapshot& now = posed_scene.posed();
    std::vector<std::shared_ptr<const AreaLamp>> lamps;
    const auto add = [&](std::shared_ptr<AreaLamp> lamp) {
        if (lamp && core::is_finite(lamp->radiance) && core::luminance(lamp->radiance) > 0.0f)
            lamps.push_back(std::move(lamp));
    };
    if (suns_)
        for (const auto& lamp : lamps_of(now)) add(lamp->whole());
    for (const auto& [object, shape] : surfaces_) {
        if (!now.objects[object].present) continue;
        const glm::vec3 normal = posed_scene.front_normal(object, 0);
        const SurfacePoint point = posed_scene.surface_at({object, 0, 1.0f / 3, 1.0f / 3}, normal);
        const auto lamp = shape({now.objects[object].to_world, normal, 2 * point.position_error});
        if (!lamp) continue;
        lamp->object = object;
        lamp->radiance = posed_scene.mean_emission(object, 0);
        add(lamp);
    }
    return lamps;
}

}  // namespace render2mpeg::renderer
