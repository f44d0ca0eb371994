// Mirrors, glass and layers with holes.
#include <cmath>

#include "scene/model/png.h"
#include "tests/reference/truth_case.h"

namespace render2mpeg::reference {
namespace {

using scene::Material;
using test::SceneBuilder;

int add_mirror(SceneBuilder& b, glm::vec3 color) {
    const int m = b.add_material(color);
    b.material(m).metallic = 1;
    b.material(m).roughness = 0;
    b.material(m).ior = 1.5f;
    return m;
}

/// A matt floor and back wall with a block on it, under a panel and a sky.
TruthCase stage_case() {
    TruthCase c;
    SceneBuilder& b = c.scene;
    b.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, b.add_material({0.6f, 0.5f, 0.4f}));
    b.add_box({-0.3f, 0, -0.9f}, {0.4f, 0.8f, -0.3f}, b.add_material({0.3f, 0.5f, 0.7f}));
    b.add_quad({-0.6f, 2.5f, -0.6f}, {1.2f, 0, 0}, {0, 0, 1.2f}, b.add_emitter({8, 7, 6}));
    b.film().sky.color = {0.3f, 0.4f, 0.6f};
    return c;
}

/// Coloured metal at the left, in which the block is seen.
TruthCase mirror() {
    TruthCase c = stage_case();
    c.scene.add_quad({-1.5f, 0, 2}, {0, 0, -4}, {0, 2, 0}, add_mirror(c.scene, {0.9f, 0.7f, 0.4f}));
    c.scene.add_camera({2, 1.2f, 1.5f}, {-1.5f, 0.6f, 0.2f}, 0.4f);
    return c;
}

/// Two that face one another, so that what is seen was mirrored up to seven times.
TruthCase mirrors_in_mirrors() {
    TruthCase c = stage_case();
    const int metal = add_mirror(c.scene, {0.95f, 0.93f, 0.9f});
    c.scene.add_quad({-1, 0, 2.5f}, {0, 0, -5}, {0, 2, 0}, metal);
    c.scene.add_quad({1, 0, -2.5f}, {0, 0, 5}, {0, 2, 0}, metal);
    c.scene.add_camera({0.8f, 1.2f, 1.8f}, {-1, 0.9f, 1.0f}, 0.5f);
    c.specular_depth = 32;
    return c;
}

/// A polished dielectric: a mirror of 4 % and more above paint.
TruthCase polished_floor() {
    TruthCase c = stage_case();
    Material& m = c.scene.material(0);
    m.roughness = 0.05f;
    m.ior = 1.5f;
    c.scene.add_camera({0.2f, 0.9f, 2.6f}, {0, 0.1f, 0}, 0.5f);
    return c;
}

/// A ball of 96 rings that mirrors the stage.
TruthCase mirror_ball() {
    TruthCase c = stage_case();
    c.scene.add_sphere({0.9f, 0.5f, 0.4f}, 0.5f, add_mirror(c.scene, {0.9f, 0.9f, 0.9f}), 96);
    c.scene.add_camera({0.9f, 0.9f, 3}, {0.9f, 0.5f, 0}, 0.28f);
    // Neighbouring rays part at the rim.
    c.allowed.patch = 0.03;
    return c;
}

/// Stands before the stage; seen through it are the block and its shadow.
int add_pane(SceneBuilder& b, const Material& material) {
    const int m = b.add_material();
    b.material(m) = material;
    b.add_quad({-1.0f, 0.02f, 0.9f}, {1.2f, 0, 0.1f}, {0, 1.6f, -0.4f}, m);
    b.add_camera({0, 1.0f, 3.5f}, {0, 0.5f, 0}, 0.5f);
    return m;
}

Material glass() {
    Material m;
    m.base_color = {0.9f, 0.7f, 0.5f, 1};
    m.transmission = 1;
    m.roughness = 0;
    m.ior = 1.5f;
    return m;
}

TruthCase pane_of_glass() {
    TruthCase c = stage_case();
    add_pane(c.scene, glass());
    return c;
}

/// Between lamp and floor, so that all light has passed it.
TruthCase light_through_glass() {
    TruthCase c = stage_case();
    const int m = c.scene.add_material();
    c.scene.material(m) = glass();
    c.scene.add_quad({-3, 2, 3}, {6, 0, 0}, {0, 0, -6}, m);
    c.scene.film().sky.color = glm::vec3(0);
    c.scene.add_camera({0, 1.5f, 3}, {0, 0, 0}, 0.5f);
    return c;
}

int add_solid_glass(SceneBuilder& b) {
    const int m = b.add_material();
    b.material(m) = glass();
    b.material(m).base_color = {1, 1, 1, 1};
    b.material(m).thickness = scene::Thickness::solid;
    return m;
}

/// A ball of tinted glass before the stage; lamps shine through it as if it were thin.
TruthCase glass_ball() {
    TruthCase c = stage_case();
    const int m = add_solid_glass(c.scene);
    c.scene.material(m).attenuation_color = {0.9f, 0.6f, 0.4f};
    c.scene.material(m).attenuation_distance = 0.5f;
    c.scene.add_sphere({0.4f, 0.6f, 0.8f}, 0.5f, m, 96);
    c.scene.add_camera({0.4f, 0.9f, 3.2f}, {0.4f, 0.6f, 0.8f}, 0.28f);
    // Ways of less than 2 % bring the light of what shines alone.
    c.allowed = {0.01, 0.06};
    return c;
}

/// A box of water on glass, both seen from above; a red ball lies in the water.
TruthCase water_on_glass() {
    TruthCase c = stage_case();
    const int base = add_solid_glass(c.scene), water = add_solid_glass(c.scene);
    c.scene.material(water).ior = 1.33f;
    c.scene.add_box({0.2f, 0.01f, 0.2f}, {1.2f, 0.3f, 1.2f}, base);
    c.scene.add_box({0.2f, 0.299f, 0.2f}, {1.2f, 0.8f, 1.2f}, water);
    c.scene.add_sphere({0.7f, 0.5f, 0.7f}, 0.15f, c.scene.add_material({0.7f, 0.1f, 0.1f}), 48);
    c.scene.add_camera({0.5f, 1.9f, 2.6f}, {0.7f, 0.5f, 0.7f}, 0.3f);
    c.allowed = {0.01, 0.03};
    return c;
}

/// What a ball of glass throws onto the floor behind it.
TruthCase caustic_of_a_ball() {
    TruthCase c = stage_case();
    c.scene.film().sky.color = glm::vec3(0);
    c.scene.add_sphere({0.6f, 0.5f, 0.6f}, 0.3f, add_solid_glass(c.scene), 96);
    c.scene.add_camera({1.4f, 1.6f, 2.0f}, {0.8f, 0, 0.9f}, 0.4f);
    c.caustics = true;
    c.allowed = {0.015, 0.06};
    return c;
}

/// And half a ring of silver before it.
TruthCase caustic_of_a_mirror() {
    TruthCase c = stage_case();
    c.scene.film().sky.color = glm::vec3(0);
    c.scene.add_quad({1.2f, 0, 1.4f}, {0, 0, -1}, {0.3f, 1, 0}, add_mirror(c.scene, {0.9f, 0.9f, 0.9f}));
    c.scene.add_camera({0.2f, 1.6f, 2.4f}, {0.7f, 0, 0.9f}, 0.5f);
    c.caustics = true;
    c.allowed = {0.015, 0.06};
    return c;
}

/// Half glass, half paint, rough.
TruthCase milky_glass() {
    TruthCase c = stage_case();
    Material m = glass();
    m.transmission = 0.5f;
    m.roughness = 0.5f;
    add_pane(c.scene, m);
    return c;
}

TruthCase blended() {
    TruthCase c = stage_case();
    Material m;
    m.base_color = {0.8f, 0.3f, 0.2f, 0.4f};
    m.alpha_mode = scene::AlphaMode::blend;
    m.ior = 1;
    add_pane(c.scene, m);
    return c;
}

/// Holes of 4 x 4 texels with hard edges.
TruthCase cut_out() {
    TruthCase c = stage_case();
    std::vector<glm::u8vec4> texels;
    for (int i = 0; i < 16; ++i) texels.emplace_back(200, 120, 60, (i + i / 4) % 2 == 0 ? 255 : 0);
    c.scene.film().images.push_back({"holes", {}, scene::encode_png(4, 4, texels)});
    Material m;
    m.alpha_mode = scene::AlphaMode::mask;
    m.base_color_texture.image = 0;
    m.base_color_texture.nearest = true;
    m.double_sided = true;
    m.ior = 1;
    add_pane(c.scene, m);
    return c;
}

}  // namespace

std::vector<NamedCase> specular_cases() {
    return {{"Mirror", mirror},
            {"MirrorsInMirrors", mirrors_in_mirrors},
            {"PolishedFloor", polished_floor},
            {"MirrorBall", mirror_ball},
            {"PaneOfGlass", pane_of_glass},
            {"LightThroughGlass", light_through_glass},
            {"MilkyGlass", milky_glass},
            {"GlassBall", glass_ball},
            {"WaterOnGlass", water_on_glass},
            {"CausticOfABall", caustic_of_a_ball},
            {"CausticOfAMirror", caustic_of_a_mirror},
            {"Blended", blended},
            {"CutOut", cut_out}};
}

}  // namespace render2mpeg::reference
