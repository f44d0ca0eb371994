// Lamps of every kind on a matt floor.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scene/model/png.h"
#include "tests/reference/truth_case.h"

namespace render2mpeg::reference {
namespace {

using test::SceneBuilder;

constexpr double pi = std::numbers::pi;
const glm::vec3 floor_color{0.6f, 0.5f, 0.4f};

/// Where a ray meets the floor.
glm::dvec3 on_floor(glm::dvec3 origin, glm::dvec3 direction) {
    return origin - direction * (origin.y / direction.y);
}

/// What the floor sends where it has this irradiance.
template <class Irradiance>
ClosedForm lit_floor(const Irradiance& irradiance) {
    return [irradiance](glm::dvec3 origin, glm::dvec3 direction) {
        return glm::dvec3(floor_color) / pi * irradiance(on_floor(origin, direction));
    };
}

/// A floor of 10 x 10, of which the camera sees 3 x 3 beside the lamps, which hang out of its sight.
TruthCase floor_case() {
    TruthCase c;
    c.scene.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, c.scene.add_material(floor_color));
    c.scene.add_camera({-3.5f, 5, 2}, {-0.3f, 0, 0}, 0.35f);
    return c;
}

/// With a block in the lamp's way, which the camera sees as well.
TruthCase with_block(TruthCase c) {
    c.scene.add_box({-0.5f, 0.4f, -0.4f}, {0.1f, 0.7f, 0.3f}, c.scene.add_material({0.3f, 0.6f, 0.7f}));
    c.closed_form = {};
    return c;
}

const glm::vec3 lamp_place{0.8f, 1.5f, 0.3f}, lamp_color{1.0f, 0.9f, 0.7f};

TruthCase point() {
    TruthCase c = floor_case();
    c.paths = 1;
    c.scene.add_point_light(lamp_place, 8, lamp_color);
    c.closed_form = lit_floor([](glm::dvec3 p) {
        const glm::dvec3 d = glm::dvec3(lamp_place) - p;
        return 8.0 * glm::dvec3(lamp_color) * d.y / std::pow(glm::length(d), 3.0);
    });
    return c;
}

TruthCase point_with_range() {
    TruthCase c = floor_case();
    c.paths = 1;
    const int light = c.scene.add_point_light(lamp_place, 8, lamp_color);
    c.scene.film().lights[static_cast<std::size_t>(light)].range = 3;
    c.closed_form = lit_floor([](glm::dvec3 p) {
        const glm::dvec3 d = glm::dvec3(lamp_place) - p;
        const double far = glm::length(d), window = std::clamp(1 - std::pow(far / 3, 4.0), 0.0, 1.0);
        return 8.0 * window * glm::dvec3(lamp_color) * d.y / std::pow(far, 3.0);
    });
    return c;
}

template <bool smooth>
TruthCase spot() {
    TruthCase c = floor_case();
    c.paths = 1;
    const glm::dvec3 along = glm::normalize(glm::dvec3(-0.7, -1.5, -0.4));
    scene::Light light;
    light.kind = scene::LightKind::spot;
    light.color = lamp_color;
    light.intensity = 8;
    light.inner_cone = 0.2f;
    light.outer_cone = 0.7f;
    light.smooth_cosine = smooth;
    scene::Node node;
    node.translation = glm::dvec3(lamp_place);
    node.rotation = SceneBuilder::looking_along(along);
    c.scene.film().nodes.push_back(node);
    light.node = static_cast<int>(c.scene.film().nodes.size()) - 1;
    c.scene.add_light(light);
    c.closed_form = lit_floor([along](glm::dvec3 p) {
        const glm::dvec3 d = glm::dvec3(lamp_place) - p;
        const double far = glm::length(d), cosine = glm::dot(-d / far, along);
        const double inner = std::cos(0.2), outer = std::cos(0.7);
        const double falloff = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
        const double shape = smooth ? cosine * (3.0 - 2.0 * falloff) : 1.0;
        return 8.0 * falloff * falloff * shape * glm::dvec3(lamp_color) * d.y / std::pow(far, 3.0);
    });
    // Where the cone ends next to nothing is left to be right of.
    c.closed_form_pixel = 0.01;
    return c;
}

const glm::dvec3 sun_along = glm::normalize(glm::dvec3(-0.4, -1, -0.3));

TruthCase sun_of(float angle) {
    TruthCase c = floor_case();
    const int sun = c.scene.add_sun(glm::vec3(sun_along), 4, lamp_color);
    c.scene.film().lights[static_cast<std::size_t>(sun)].angle = angle;
    c.closed_form = lit_floor([](glm::dvec3) { return -4.0 * sun_along.y * glm::dvec3(lamp_color); });
    return c;
}
TruthCase directional() {
    TruthCase c = sun_of(0);
    c.paths = 1;
    return c;
}
TruthCase soft_sun() {
    return sun_of(0.1f);
}

/// Half of its disc is below the horizon.
TruthCase setting_sun() {
    TruthCase c = floor_case();
    const int sun = c.scene.add_sun({-1, -0.02f, -0.3f}, 4, lamp_color);
    c.scene.film().lights[static_cast<std::size_t>(sun)].angle = 0.1f;
    return c;
}

/// [Lambert1760]; `corners` in the order in which they are seen counter-clockwise from below.
double polygon_form(const std::array<glm::dvec3, 4>& corners, glm::dvec3 place) {
    double sum = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3 a = glm::normalize(corners[k] - place), b = glm::normalize(corners[(k + 1) % 4] - place);
        sum += std::acos(glm::dot(a, b)) * glm::normalize(glm::cross(a, b)).y;
    }
    return 0.5 * std::abs(sum);
}

const glm::vec3 panel_corner{0.3f, 1.4f, -0.7f}, panel_u{0.9f, 0.2f, 0}, panel_v{0, 0, 0.8f}, panel_light{6, 5, 4};

TruthCase panel() {
    TruthCase c = floor_case();
    c.scene.add_quad(panel_corner, panel_u, panel_v, c.scene.add_emitter(panel_light));
    c.closed_form = lit_floor([](glm::dvec3 p) {
        const glm::dvec3 a(panel_corner), u(panel_u), v(panel_v);
        return glm::dvec3(panel_light) * polygon_form({a, a + u, a + u + v, a + v}, p);
    });
    return c;
}

/// Stands on the floor, and faces it sideways.
TruthCase panel_on_floor() {
    TruthCase c = floor_case();
    c.finding = Finding::by_chance;
    c.paths *= 3;
    c.scene.add_quad({0.55f, 0, -0.4f}, {0, 0, 1.2f}, {0, 0.9f, 0}, c.scene.add_emitter(panel_light));
    return c;
}

/// Has less than an eighth of the other's power and is near, where it is gathered as light points.
TruthCase dim_panel() {
    TruthCase c = panel();
    c.scene.add_quad({0.55f, 0.1f, -0.3f}, {0, 0, 0.6f}, {0, 0.4f, 0}, c.scene.add_emitter({2, 2, 2}));
    c.closed_form = {};
    return c;
}

/// Shines through an image of 4 x 4 texels.
TruthCase panel_with_image() {
    TruthCase c = floor_case();
    const int material = c.scene.add_emitter({12, 12, 12});
    std::vector<glm::u8vec4> texels;
    for (int i = 0; i < 16; ++i) texels.emplace_back(40 + 13 * i, i % 3 == 0 ? 220 : 90, i % 4 < 2 ? 30 : 200, 255);
    c.scene.film().images.push_back({"pattern", {}, scene::encode_png(4, 4, texels)});
    c.scene.material(material).emission_texture.image = 0;
    c.scene.add_quad(panel_corner, panel_u, panel_v, material);
    return c;
}

TruthCase sphere() {
    TruthCase c = floor_case();
    const glm::dvec3 centre{0.7, 1.6, -0.4};
    const double radius = 0.3;
    c.scene.add_sphere(glm::vec3(centre), static_cast<float>(radius), c.scene.add_emitter({12, 10, 8}), 48);
    c.closed_form = lit_floor([=](glm::dvec3 p) {
        const glm::dvec3 d = centre - p;
        const double far = glm::length(d);
        return glm::dvec3(12, 10, 8) * (pi * radius * radius / (far * far) * d.y / far);
    });
    return c;
}

/// Alpha hides what is seen of it, not what it shines.
TruthCase unseen_sphere() {
    TruthCase c = sphere();
    for (scene::Material& m : c.scene.film().materials) {
        if (!m.emits()) continue;
        m.base_color.a = 0;
        m.alpha_mode = scene::AlphaMode::blend;
    }
    return c;
}

/// Touches the floor.
TruthCase sphere_on_floor() {
    TruthCase c = floor_case();
    c.finding = Finding::by_chance;
    c.paths *= 3;
    c.scene.add_sphere({0.7f, 0.3f, -0.4f}, 0.3f, c.scene.add_emitter({3, 3, 3}), 48);
    return c;
}

/// A cube: no closed form of its own, so that it is gathered as light points.
TruthCase cube() {
    TruthCase c = floor_case();
    c.scene.add_box({0.5f, 1.3f, -0.6f}, {0.9f, 1.7f, -0.2f}, c.scene.add_emitter({9, 8, 7}));
    return c;
}

TruthCase even_sky() {
    TruthCase c = floor_case();
    c.scene.film().sky.color = {0.5f, 0.7f, 1.0f};
    c.closed_form = lit_floor([](glm::dvec3) { return pi * glm::dvec3(0.5f, 0.7f, 1.0f); });
    return c;
}

/// Bands of grey, a blue gradient, and a bright spot of some 8 degrees; turned.
TruthCase sky_image() {
    TruthCase c = floor_case();
    constexpr int width = 96, height = 48;
    std::vector<glm::u8vec4> texels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool bright = std::abs(x - 60) < 2 && std::abs(y - 14) < 2;
            const int band = (x / 8) % 2 == 0 ? 60 : 30;
            texels.push_back(bright ? glm::u8vec4(255) : glm::u8vec4(band, band, 100 - y, 255));
        }
    c.scene.film().images.push_back({"sky", {}, scene::encode_png(width, height, texels)});
    c.scene.film().sky.image = 0;
    c.scene.film().sky.color = glm::vec3(10);
    c.scene.film().sky.rotation = 0.8f;
    return c;
}

template <MakeCase make>
TruthCase blocked() {
    return with_block(make());
}

}  // namespace

std::vector<NamedCase> lamp_cases() {
    return {{"Point", point},
            {"PointBlocked", blocked<point>},
            {"PointWithRange", point_with_range},
            {"Spot", spot<false>},
            {"SpotBlocked", blocked<spot<false>>},
            {"SpotByTheCosine", spot<true>},
            {"Directional", directional},
            {"DirectionalBlocked", blocked<directional>},
            {"SoftSun", soft_sun},
            {"SoftSunBlocked", blocked<soft_sun>},
            {"SettingSun", setting_sun},
            {"Panel", panel},
            {"PanelBlocked", blocked<panel>},
            {"PanelOnFloor", panel_on_floor},
            {"PanelOnFloorBlocked", blocked<panel_on_floor>},
            {"DimPanel", dim_panel},
            {"PanelWithImage", panel_with_image},
            {"PanelWithImageBlocked", blocked<panel_with_image>},
            {"Sphere", sphere},
            {"SphereBlocked", blocked<sphere>},
            {"SphereOnFloor", sphere_on_floor},
            {"UnseenSphere", unseen_sphere},
            {"UnseenSphereBlocked", blocked<unseen_sphere>},
            {"Cube", cube},
            {"CubeBlocked", blocked<cube>},
            {"EvenSky", even_sky},
            {"EvenSkyBlocked", blocked<even_sky>},
            {"SkyImage", sky_image},
            {"SkyImageBlocked", blocked<sky_image>}};
}

}  // namespace render2mpeg::reference
