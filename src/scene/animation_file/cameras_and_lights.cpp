#include "scene/animation_file/cameras_and_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <map>
#include <numbers>
#include <string>

#include "core/text.h"
#include "scene/animation_file/keys.h"
#include "scene/animation_file/shapes.h"

namespace render2mpeg::scene {
namespace {

namespace keys = animation_file_keys;

/// Value of a curve at first, and a track where it changes.
float add_curve(const Curve& curve, TrackTarget target, std::size_t camera, Animation& film) {
    double first = 0;
    curve.sample(curve.times.front(), {&first, 1});
    if (curve.times.size() > 1) film.tracks.push_back(track_of(curve, target, static_cast<int>(camera)));
    return static_cast<float>(first);
}

/// Aperture and focus; an object's name waits for the objects (focus_on_objects).
void read_aperture(const JsonValue& value, std::size_t index, CameraLens& lens, Animation& film,
                   const FilmClock& clock) {
    const auto f_stop = value.find("f_stop");
    if (f_stop && f_stop->is_text()) {
        constexpr std::array<std::string_view, 1> words{"off"};
        f_stop->word(words);
    } else {
        const Curve stops = curve_of(value, {"f_stop", 1, 0.01, 1000, true}, clock, keys::camera_key);
        if (!stops.empty()) lens.f_stop = add_curve(stops, TrackTarget::f_stop, index, film);
    }
    const auto focus = value.find("focus");
    if (focus && focus->is_list()) {
        lens.focus_point = focus->position();
    } else if (!focus || !focus->is_text()) {
        const Curve distances = curve_of(value, {"focus", 1, 1e-6, 1e9, true}, clock, keys::camera_key);
        if (!distances.empty())
            lens.focus_distance = add_curve(distances, TrackTarget::focus_distance, index, film);
        else if (lens.f_stop > 0)
            value.fail("has an `f_stop` and no `focus`");
    }
    // chosen: 24 mm, of 35 mm film.
    if (const auto v = value.find("sensor_height"))
        lens.sensor_height = static_cast<float>(v->number(0.1, 1000) / 1000);
    if (const auto v = value.find("blades")) {
        lens.blades = static_cast<int>(v->integer(0, 64));
        if (lens.blades == 1 || lens.blades == 2) v->fail("is 0 (round) or 3 or more");
    }
    if (const auto v = value.find("blade_rotation"))
        lens.blade_rotation = static_cast<float>(glm::radians(v->number(-360, 360)));
    value.set("squeeze", lens.squeeze, 0.1, 10);
}

/// Two angles of a panorama's edges, degrees; nothing where they are left out.
void read_edges(const JsonValue& value, std::string_view key, double most, double& from, double& to) {
    const auto edges = value.find(key);
    if (!edges) return;
    const std::vector<JsonValue> two = edges->list(2, 2);
    from = glm::radians(two[0].number(-most, most));
    to = glm::radians(two[1].number(-most, most));
    if (!(from < to)) edges->fail("go from the lower to the higher");
}

/// The part of the sphere that a camera with a `projection` shows.
void read_panorama(const JsonValue& value, CameraLens& lens, const Curve& fov) {
    const auto projection = value.find("projection");
    if (!projection) {
        for (const std::string_view key : {"longitudes", "latitudes"})
            if (value.has(key)) value.need(key).fail("are those of a camera with a `projection`");
        return;
    }
    const std::size_t name = projection->word(panorama_names);
    for (const std::string_view key :
         {"height", "shift", "f_stop", "focus", "sensor_height", "blades", "blade_rotation", "squeeze"})
        if (value.has(key)) value.need(key).fail("is not a panorama's, which has no lens");
    if (!fov.empty()) value.fail("has both `fov` and `projection`");
    SphereWindow window = panorama_windows[name];
    if (window == SphereWindow()) {
        read_edges(value, "longitudes", 180, window.west, window.east);
        read_edges(value, "latitudes", 90, window.south, window.north);
    } else {
        for (const std::string_view key : {"longitudes", "latitudes"})
            if (value.has(key)) value.need(key).fail("are those of an `equirectangular` camera");
    }
    make_panorama(lens, window);
}

/// Where a camera's eyes are.
void read_stereo(const JsonValue& value, CameraLens& lens) {
    const auto eyes = value.find("stereo");
    if (!eyes) return;
    eyes->allow_only(keys::stereo);
    if (lens.projection == ProjectionKind::orthographic) eyes->fail("is not for parallel rays, which see no depth");
    Stereo& stereo = lens.stereo;
    stereo.interocular_distance = eyes->number_or("interocular_distance", 0, 1e6, stereo.interocular_distance);
    stereo.convergence_distance = eyes->number_or("convergence_distance", 1e-6, 1e9, stereo.convergence_distance);
    if (const auto v = eyes->find("convergence"))
        stereo.convergence = static_cast<Convergence>(v->word(convergence_names));
    if (const auto v = eyes->find("pivot")) stereo.pivot = static_cast<Pivot>(v->word(pivot_names));
    if (const auto v = eyes->find("spherical")) stereo.spherical = v->boolean();
    const auto merge = eyes->find("pole_merge");
    if (!merge) return;
    if (merge->is_text()) {
        constexpr std::array<std::string_view, 1> words{"off"};
        merge->word(words);
        stereo.pole_merge_from = stereo.pole_merge_to = 0;
        return;
    }
    const std::vector<JsonValue> two = merge->list(2, 2);
    stereo.pole_merge_from = glm::radians(two[0].number(0, 90));
    stereo.pole_merge_to = glm::radians(two[1].number(0.01, 90));
    if (stereo.pole_merge_from > stereo.pole_merge_to) merge->fail("go from the lower to the higher");
}

void focus_on_object(const JsonValue& camera, CameraLens& lens, const Animation& film) {
    const auto focus = camera.find("focus");
    if (!focus || !focus->is_text()) return;
    const std::string name = focus->text();
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < film.objects.size(); ++i) {
        names.emplace_back(film.objects[i].name);
        if (film.objects[i].name == name) lens.focus_objects.push_back(static_cast<int>(i));
    }
    if (!lens.focus_objects.empty()) return;
    focus->fail("there is no object \"" + name + "\"" + core::did_you_mean(name, names, "\"", "\""));
}

void read_camera(const JsonValue& value, const std::string& name, std::size_t index, Animation& film,
                 const FilmClock& clock) {
    value.allow_only(keys::camera);
    CameraLens lens;
    lens.name = name;
    lens.node = add_node(film, name, -1);
    place(film, lens.node, value, clock, keys::camera_key);
    if (const auto v = value.find("shift")) {
        const std::vector<JsonValue> shift = v->list(2, 2);
        lens.shift = glm::vec2(shift[0].number(-10, 10), shift[1].number(-10, 10));
    }
    value.set("near", lens.near, 0, 1e6);
    value.set("far", lens.far, 1e-6, 1e9);

    // An orthographic camera has a height instead.
    const Curve fov = curve_of(value, {"fov", 1, 0.1, 175, true}, clock, keys::camera_key);
    if (const auto v = value.find("height")) {
        if (!fov.empty()) value.fail("has both `fov` (perspective) and `height` (parallel projection)");
        lens.projection = ProjectionKind::orthographic;
        lens.y_magnification = static_cast<float>(v->number(1e-6, 1e6) / 2);
    }
    // chosen: 45 degrees, the normal lens of a 4:3 picture's height.
    double degrees = 45;
    if (!fov.empty()) fov.sample(fov.times.front(), {&degrees, 1});
    lens.vertical_fov = static_cast<float>(glm::radians(degrees));
    if (fov.times.size() > 1)
        film.tracks.push_back(
            track_of(fov, TrackTarget::field_of_view, static_cast<int>(index), glm::pi<double>() / 180));
    read_aperture(value, index, lens, film, clock);
    read_panorama(value, lens, fov);
    read_stereo(value, lens);
    film.cameras.insert(film.cameras.begin() + static_cast<std::ptrdiff_t>(index), lens);
}

constexpr std::array<std::string_view, 5> kinds{"point", "spot", "sun", "panel", "sphere"};
constexpr std::array<std::string_view, 2> spot_falloffs{"gltf", "blender-3"};

/// What shows a lamp itself.
enum class Seen { by_nothing, by_mirrors, by_all };

Seen seen_of(const JsonValue& light, Seen otherwise) {
    constexpr std::array<std::string_view, 1> words{"mirrors"};
    const auto seen = light.find("seen");
    if (!seen) return otherwise;
    if (seen->is_text()) return seen->word(words), Seen::by_mirrors;
    return seen->boolean() ? Seen::by_all : Seen::by_nothing;
}

/// Lights shine along -z.
Mesh flat_panel(glm::dvec2 size) {
    Mesh mesh = quad_mesh(size, TextureLayout::fit);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.positions[i] = {-mesh.positions[i].x, mesh.positions[i].y, 0};
        mesh.normals[i] = {0, 0, -1};
    }
    return mesh;
}

/// An octagon of the ellipse's area, since few corners allow light by the area lamp.
Mesh round_panel(glm::dvec2 diameters) {
    const double radius = std::sqrt(std::numbers::pi / std::sqrt(8.0)) / 2;
    Mesh mesh = disc_mesh(1, 8, TextureLayout::fit);
    const glm::vec2 scale(radius * diameters);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.positions[i] = {scale.x * mesh.positions[i].x, scale.y * mesh.positions[i].z, 0};
        mesh.normals[i] = {0, 0, -1};
    }
    return mesh;
}

/// Colour of a light's copy, and its number among the light's colours.
std::pair<glm::vec3, std::size_t> color_of(const JsonValue& value, std::size_t copy) {
    const auto several = value.find("colors");
    if (!several) return {value.has("color") ? value.need("color").color(1) : glm::vec3(1), 0};
    const std::vector<JsonValue> colors = several->list(1, 1000);
    return {colors[copy % colors.size()].color(1), copy % colors.size()};
}

class Lights {
  public:
    Lights(Animation& film, const FilmClock& clock) : film_(film), clock_(clock) {}

    void build(const JsonValue& value, std::size_t number);

  private:
    void build_punctual(const JsonValue& value, const std::string& name, int node, std::size_t copy);
    void build_lamp(const JsonValue& value, const std::string& name, int node, std::size_t copy);
    Curve power_of(const JsonValue& value, std::size_t copy);

    Animation& film_;
    const FilmClock& clock_;
    std::map<std::string, int> mesh_at_, material_at_;  ///< by their place in the file: copies share them
};

Curve Lights::power_of(const JsonValue& value, std::size_t copy) {
    Curve power = curve_of(value, {"power", 1, 0, 1e6, true}, clock_, keys::light_key);
    const auto stagger = value.find("stagger");
    if (stagger && power.times.size() > 1)
        for (double& time : power.times) time += clock_.seconds(*stagger) * static_cast<double>(copy);
    return power;
}

void Lights::build_punctual(const JsonValue& value, const std::string& name, int node, std::size_t copy) {
    constexpr std::array<LightKind, 3> kind_of{LightKind::point, LightKind::spot, LightKind::directional};
    constexpr std::array<double, 3> usual{10, 10, 3};
    const std::size_t kind = value.need("kind").word(kinds);
    Light light;
    light.name = name;
    light.node = node;
    light.kind = kind_of[kind];
    light.intensity = static_cast<float>(value.number_or("intensity", 0, 1e9, usual[kind]));
    light.color = color_of(value, copy).first;
    value.set("range", light.range, 0, 1e7);
    if (light.kind == LightKind::directional && value.has("angle"))
        light.angle = static_cast<float>(glm::radians(value.need("angle").number(0, 180) / 2));
    if (const Seen seen = seen_of(value, Seen::by_nothing); seen != Seen::by_nothing) {
        light.disc = std::sin(light.angle);
        light.seen = seen == Seen::by_all;
    }
    if (light.kind == LightKind::spot) {
        const double angle = value.number_or("angle", 0.1, 180, 60);
        const double softness = value.number_or("softness", 0, 1, 0.3);
        light.outer_cone = static_cast<float>(glm::radians(angle / 2));
        // The two cones must not coincide.
        light.inner_cone = static_cast<float>(glm::radians(angle / 2) * std::min(1 - softness, 0.999));
        if (value.has("radius")) light.disc = static_cast<float>(size_or(value, "radius", 0));
        if (const auto falloff = value.find("falloff")) light.smooth_cosine = falloff->word(spot_falloffs) == 1;
    }
    const Curve power = power_of(value, copy);
    const int index = static_cast<int>(film_.lights.size());
    film_.lights.push_back(light);
    if (!power.empty()) film_.tracks.push_back(track_of(power, TrackTarget::light_intensity, index));
}

void Lights::build_lamp(const JsonValue& value, const std::string& name, int node, std::size_t copy) {
    const bool is_panel = value.need("kind").text() == "panel";
    if (mesh_at_.find(value.place()) == mesh_at_.end()) {
        Mesh mesh;
        if (is_panel) {
            const glm::dvec2 size = sizes_or<2>(value, "size", 1);
            const auto round = value.find("round");
            mesh = round && round->boolean() ? round_panel(size) : flat_panel(size);
        } else {
            mesh = lamp_mesh(size_or(value, "radius", 0.1));
        }
        mesh.name = value.place();
        film_.meshes.push_back(std::move(mesh));
        mesh_at_[value.place()] = static_cast<int>(film_.meshes.size()) - 1;
    }

    // Copies share a material unless they differ in colour or time.
    auto [color, variant] = color_of(value, copy);
    if (value.has("stagger")) variant = copy;
    const std::string place = value.place() + "/" + std::to_string(variant);
    if (material_at_.find(place) == material_at_.end()) {
        Material material = matt(name, glm::vec3(0));
        material.emission = color * static_cast<float>(value.number_or("intensity", 0, 1e6, 10));
        if (const Seen seen = seen_of(value, Seen::by_all); seen != Seen::by_all) {
            // Alpha hides what is seen of a surface, not what it shines.
            material.base_color.a = 0;
            material.alpha_mode = AlphaMode::blend;
            material.mirrored = seen == Seen::by_mirrors;
        }
        const int index = static_cast<int>(film_.materials.size());
        film_.materials.push_back(material);
        material_at_[place] = index;
        const Curve power = power_of(value, copy);
        if (!power.empty()) film_.tracks.push_back(track_of(power, TrackTarget::emission, index));
    }
    add_object(film_, name, node, mesh_at_[value.place()], material_at_[place]);
}

void Lights::build(const JsonValue& value, std::size_t number) {
    value.allow_only(keys::light);
    const std::size_t kind = value.need("kind").word(kinds);
    const bool punctual = kind < 3;
    const auto only_for = [&](std::string_view key, std::initializer_list<std::size_t> allowed) {
        if (value.has(key) && std::find(allowed.begin(), allowed.end(), kind) == allowed.end())
            value.need(key).fail("a " + std::string(kinds[kind]) + " light has no such key");
    };
    only_for("angle", {1, 2});
    only_for("softness", {1});
    only_for("falloff", {1});
    for (const std::string_view key : {"elevation", "azimuth"}) only_for(key, {2});
    only_for("range", {0, 1});
    only_for("size", {3});
    only_for("round", {3});
    only_for("radius", {1, 4});
    only_for("seen", {2, 3, 4});
    if (kind == 2 && value.has("seen") && !value.has("angle"))
        value.need("seen").fail("shows a sun of an `angle` alone");

    const std::string name =
        value.has("name") ? value.need("name").text() : std::string(kinds[kind]) + " " + std::to_string(number + 1);
    const int placed = add_node(film_, name, -1);
    place(film_, placed, value, clock_, keys::light_key);
    if (value.has("elevation") || value.has("azimuth")) {
        if (value.has("rotate") || value.has("look_at"))
            value.fail("say either `elevation` and `azimuth`, or `rotate`, or `look_at`");
        const double up = value.need("elevation").number(-90, 90), round = value.number_or("azimuth", -360, 360, 0);
        // Not turned, it shines along -z, out of +z: azimuth 0.
        film_.nodes[static_cast<std::size_t>(placed)].rotation = rotation_of({-up, round, 0});
    }

    std::size_t copy_number = 0;
    for (const int node : copies_of(value, placed, film_)) {
        const std::string own = film_.nodes[static_cast<std::size_t>(node)].name;
        if (punctual)
            build_punctual(value, own, node, copy_number);
        else
            build_lamp(value, own, node, copy_number);
        ++copy_number;
    }
}

}  // namespace

void read_cameras(const JsonValue& film_value, Animation& film, const FilmClock& clock) {
    const auto one = film_value.find("camera"), several = film_value.find("cameras");
    if (one && several) one->fail("stands beside `cameras`; put all of them there");
    if (one) read_camera(*one, "camera", 0, film, clock);
    if (!several) return;
    std::size_t index = 0;
    for (const auto& [name, value] : several->members()) read_camera(value, name, index++, film, clock);
}

void focus_on_objects(const JsonValue& film_value, Animation& film) {
    if (const auto one = film_value.find("camera")) focus_on_object(*one, film.cameras.front(), film);
    const auto several = film_value.find("cameras");
    if (!several) return;
    std::size_t index = 0;
    for (const auto& [name, value] : several->members()) focus_on_object(value, film.cameras[index++], film);
}

void read_shots(const JsonValue& shots, Animation& film, const FilmClock& clock) {
    std::vector<std::string_view> names;
    for (const CameraLens& lens : film.cameras) names.emplace_back(lens.name);
    film.shots.clear();
    for (const JsonValue& value : shots.list(1, 10000)) {
        value.allow_only(keys::shot);
        Shot shot;
        const JsonValue at = value.need("at");
        shot.frame = std::llround(clock.seconds(at) * clock.rate);
        if (film.shots.empty() && shot.frame != 0) at.fail("must be 0: the film begins with its first shot");
        if (!film.shots.empty() && shot.frame <= film.shots.back().frame)
            at.fail("must be at least a frame later than the shot before");
        const JsonValue camera = value.need("camera");
        const std::string name = camera.text();
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            camera.fail("there is no camera \"" + name + "\"" + core::did_you_mean(name, names, "\"", "\""));
        shot.camera = static_cast<int>(found - names.begin());
        film.shots.push_back(shot);
    }
}

void read_lights(const JsonValue& lights, Animation& film, const FilmClock& clock) {
    Lights all(film, clock);
    std::size_t number = 0;
    for (const JsonValue& light : lights.list(0, 100000)) all.build(light, number++);
}

}  // namespace render2mpeg::scene
