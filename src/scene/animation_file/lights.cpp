#include "scene/animation_file/lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "scene/animation_file/keys.h"
#include "scene/animation_file/movement.h"
#include "scene/animation_file/shapes.h"
#include "scene/animation_file/sizes.h"

namespace render2mpeg::scene {
namespace {

namespace keys = animation_file_keys;

constexpr std::array<std::string_view, 5> kinds{"point", "spot", "sun", "panel", "sphere"};

/// Lights shine along -z.
Mesh flat_panel(glm::dvec2 size) {
    Mesh mesh = quad_mesh(size, TextureLayout::fit);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.positions[i] = {-mesh.positions[i].x, mesh.positions[i].y, 0};
        mesh.normals[i] = {0, 0, -1};
    }
    return mesh;
}

/// An octagon of the ellipse's area: with no more corners than these a lamp is lit by as a whole.
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

/// Builds the lights of one file.
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
    light.intensity = static_cast<float>(value.has("intensity") ? value.need("intensity").number(0, 1e9) : usual[kind]);
    if (const auto v = value.find("color")) light.color = v->color(1);
    if (const auto v = value.find("colors")) {
        const std::vector<JsonValue> colors = v->list(1, 1000);
        light.color = colors[copy % colors.size()].color(1);
    }
    if (const auto v = value.find("range")) light.range = static_cast<float>(v->number(0, 1e7));
    if (light.kind == LightKind::directional && value.has("angle"))
        light.angle = static_cast<float>(glm::radians(value.need("angle").number(0, 180) / 2));
    if (light.kind == LightKind::spot) {
        const double angle = value.has("angle") ? value.need("angle").number(0.1, 180) : 60;
        const double softness = value.has("softness") ? value.need("softness").number(0, 1) : 0.3;
        light.outer_cone = static_cast<float>(glm::radians(angle / 2));
        // The two cones must not coincide.
        light.inner_cone = static_cast<float>(glm::radians(angle / 2) * std::min(1 - softness, 0.999));
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
            const auto s = sizes_or<2>(value, "size", 1);
            const auto round = value.find("round");
            mesh = round && round->boolean() ? round_panel({s[0], s[1]}) : flat_panel({s[0], s[1]});
        } else {
            mesh = lamp_mesh(size_or(value, "radius", 0.1));
        }
        mesh.name = value.place();
        film_.meshes.push_back(std::move(mesh));
        mesh_at_[value.place()] = static_cast<int>(film_.meshes.size()) - 1;
    }

    // Copies share a material unless they differ in colour or time.
    std::size_t variant = 0;
    glm::vec3 color = value.has("color") ? value.need("color").color(1) : glm::vec3(1);
    if (const auto v = value.find("colors")) {
        const std::vector<JsonValue> colors = v->list(1, 1000);
        variant = copy % colors.size();
        color = colors[variant].color(1);
    }
    if (value.has("stagger")) variant = copy;
    const std::string place = value.place() + "/" + std::to_string(variant);
    if (material_at_.find(place) == material_at_.end()) {
        Material material;
        material.name = name;
        material.base_color = glm::vec4(0, 0, 0, 1);
        material.specular_glossiness = true;
        material.specular = glm::vec3(0);
        material.glossiness = 0;
        material.emission =
            color * static_cast<float>(value.has("intensity") ? value.need("intensity").number(0, 1e6) : 10);
        if (const auto v = value.find("seen"); v && !v->boolean()) {
            // Alpha hides what is seen of a surface, not what it shines.
            material.base_color.a = 0;
            material.alpha_mode = AlphaMode::blend;
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
    for (const std::string_view key : {"elevation", "azimuth"}) only_for(key, {2});
    only_for("range", {0, 1});
    only_for("size", {3});
    only_for("round", {3});
    only_for("radius", {4});
    only_for("seen", {3, 4});

    const std::string name =
        value.has("name") ? value.need("name").text() : std::string(kinds[kind]) + " " + std::to_string(number + 1);
    const int placed = add_node(film_, name, -1);
    place(film_, placed, value, clock_, keys::light_key);
    if (value.has("elevation") || value.has("azimuth")) {
        if (value.has("rotate") || value.has("look_at"))
            value.fail("say either `elevation` and `azimuth`, or `rotate`, or `look_at`");
        const double up = value.need("elevation").number(-90, 90),
                     round = value.has("azimuth") ? value.need("azimuth").number(-360, 360) : 0;
        // Not turned, it shines along -z, out of +z: azimuth 0.
        film_.nodes[static_cast<std::size_t>(placed)].rotation = rotation_of({-up, round, 0});
    }

    std::size_t copy_number = 0;
    for (Node& copy : copies_of(value)) {
        int node = placed;
        if (value.has("repeat")) {
            copy.name = name + " " + std::to_string(copy_number + 1);
            copy.parent = placed;
            film_.nodes.push_back(copy);
            node = static_cast<int>(film_.nodes.size()) - 1;
        }
        if (punctual)
            build_punctual(value, film_.nodes[static_cast<std::size_t>(node)].name, node, copy_number);
        else
            build_lamp(value, film_.nodes[static_cast<std::size_t>(node)].name, node, copy_number);
        ++copy_number;
    }
}

}  // namespace

void read_lights(const JsonValue& lights, Animation& film, const FilmClock& clock) {
    Lights all(film, clock);
    std::size_t number = 0;
    for (const JsonValue& light : lights.list(0, 100000)) all.build(light, number++);
}

}  // namespace render2mpeg::scene
