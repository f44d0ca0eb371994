// Materials of every kind, under lamps whose light they scatter straight to the eye.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/model/png.h"
#include "tests/reference/scattering.h"
#include "tests/reference/truth_case.h"

namespace render2mpeg::reference {
namespace {

using scene::Material;
using test::SceneBuilder;

constexpr double pi = std::numbers::pi;

const glm::vec3 painted{0.7f, 0.45f, 0.25f};
constexpr float index_of_glass = 1.5f;

using MakeMaterial = void (*)(SceneBuilder& b, Material& m);

void matt(SceneBuilder&, Material&) {}

/// A dielectric of this many tenths of roughness.
template <int tenths>
void rough(SceneBuilder&, Material& m) {
    m.ior = index_of_glass;
    m.roughness = 0.1f * tenths;
}
template <int tenths>
void metal(SceneBuilder& b, Material& m) {
    rough<tenths>(b, m);
    m.metallic = 1;
}
void half_metal(SceneBuilder& b, Material& m) {
    rough<4>(b, m);
    m.metallic = 0.5f;
}

void glossiness(SceneBuilder&, Material& m) {
    m.specular_glossiness = true;
    m.specular = {0.3f, 0.2f, 0.1f};
    m.glossiness = 0.5f;
}

/// Texels as large as a sixth of the picture, so that no filter matters but at their edges.
int add_image(SceneBuilder& b, int width, int height, const std::vector<glm::u8vec4>& texels) {
    b.film().images.push_back({"texels", {}, scene::encode_png(width, height, texels)});
    return static_cast<int>(b.film().images.size()) - 1;
}

std::vector<glm::u8vec4> pattern(int count, int step) {
    std::vector<glm::u8vec4> texels;
    for (int i = 0; i < count; ++i)
        texels.emplace_back(60 + step * i % 190, 250 - step * 3 * i % 200, 40 + step * 5 * i % 210, 255);
    return texels;
}

void color_image(SceneBuilder& b, Material& m) {
    m.base_color_texture.image = add_image(b, 8, 8, pattern(64, 37));
    m.base_color = {1, 1, 1, 1};
}

/// Four values of roughness beside metal or none, with hard edges: each roughness has tables of its own.
void roughness_image(SceneBuilder& b, Material& m) {
    std::vector<glm::u8vec4> texels;
    for (int i = 0; i < 16; ++i) texels.emplace_back(0, 255 - 40 * (i % 4), i % 3 == 0 ? 255 : 0, 255);
    m.ior = index_of_glass;
    m.metallic = 1;
    m.metallic_roughness_texture.image = add_image(b, 4, 4, texels);
    m.metallic_roughness_texture.nearest = true;
}

/// Slopes of up to 0.3 that change slowly.
void normal_map(SceneBuilder& b, Material& m) {
    std::vector<glm::u8vec4> texels;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            const glm::vec3 n = glm::normalize(glm::vec3(0.3f * std::sin(0.8f * static_cast<float>(x)),
                                                         0.3f * std::cos(0.6f * static_cast<float>(y)), 1));
            texels.emplace_back(glm::u8vec3(glm::round(127.5f * (n + 1.0f))), 255);
        }
    rough<5>(b, m);
    m.normal_texture.image = add_image(b, 16, 16, texels);
}

/// A floor of the material, looked at from `height` at a distance of 4; a panel stands behind it, where the floor
/// mirrors it to the eye.
TruthCase lit_floor(MakeMaterial change, float height) {
    TruthCase c;
    const int material = c.scene.add_material(painted);
    change(c.scene, c.scene.material(material));
    c.scene.add_quad({-3, 0, 2}, {6, 0, 0}, {0, 0, -12}, material);
    c.scene.add_camera({0, height, 4}, {0, 0, 0}, 0.3f);
    return c;
}

/// Under a panel, a coloured sky and a sun without size.
template <MakeMaterial change>
TruthCase under_all() {
    TruthCase c = lit_floor(change, 1.6f);
    c.scene.add_quad({-1.2f, 0.3f, -2.5f}, {2, 0, 0}, {0, 1.5f, 0}, c.scene.add_emitter({3, 2.5f, 2}));
    c.scene.film().sky.color = {0.3f, 0.4f, 0.6f};
    c.scene.add_sun({-0.6f, -1, 0.4f}, 1.5f);
    return c;
}

/// Narrow lobes are found by following them.
template <MakeMaterial change>
TruthCase under_all_by_chance() {
    TruthCase c = under_all<change>();
    c.finding = Finding::by_chance;
    return c;
}

/// The renderer filters images, the path tracer does not.
template <MakeMaterial change>
TruthCase under_all_filtered() {
    TruthCase c = under_all<change>();
    c.allowed.patch = 0.03;
    return c;
}

/// Each corner of the floor has a colour of its own.
TruthCase vertex_colors() {
    TruthCase c = under_all<matt>();
    c.scene.film().meshes[0].colors = {
        {1, 0.2f, 0.4f, 1}, {0.3f, 1, 0.5f, 1}, {0.9f, 0.8f, 0.1f, 1}, {0.2f, 0.3f, 1, 1}};
    return c;
}

/// Under a soft sun and a round lamp, both where the floor mirrors them to the eye.
template <MakeMaterial change>
TruthCase under_round_lamps() {
    TruthCase c = lit_floor(change, 1.6f);
    c.scene.add_sphere({-0.3f, 1, -2.2f}, 0.3f, c.scene.add_emitter({6, 5, 4}), 48);
    const int sun = c.scene.add_sun({-0.15f, -0.35f, 1}, 1.5f);
    c.scene.film().lights[static_cast<std::size_t>(sun)].angle = 0.1f;
    return c;
}

/// Under a sun without size alone, which glTF's formula answers.
template <MakeMaterial change>
TruthCase under_sun() {
    TruthCase c = lit_floor(change, 1.2f);
    const glm::dvec3 to_sun = glm::normalize(glm::dvec3(0.3, 1, -0.8));
    c.scene.add_sun(-glm::vec3(to_sun), 2);
    Material m = c.scene.material(0);
    c.closed_form = [=](glm::dvec3, glm::dvec3 direction) {
        const glm::dvec3 up(0, 1, 0);
        return 2.0 * metallic_roughness(m, -direction.y).times_cosine(up, -direction, to_sun);
    };
    // The renderer's table of lobes is within 0.015 (docs/model/materials.md).
    c.closed_form_pixel = 0.015;
    c.paths = 1;
    return c;
}

/// White metal under an even sky reflects all of it, whatever its roughness.
template <int tenths>
TruthCase furnace() {
    TruthCase c = lit_floor(metal<tenths>, 1.2f);
    c.scene.material(0).base_color = {1, 1, 1, 1};
    c.scene.film().sky.color = glm::vec3(1);
    c.closed_form = [](glm::dvec3, glm::dvec3) { return glm::dvec3(1); };
    c.closed_form_pixel = 0.02;
    c.finding = Finding::by_chance;
    return c;
}

/// A ball of metal of 96 rings under the same lamps, where its lobe is as wide as lamps are.
TruthCase metal_ball() {
    TruthCase c;
    const int material = c.scene.add_material(painted);
    metal<4>(c.scene, c.scene.material(material));
    c.scene.add_sphere({0, 0, 0}, 1, material, 96);
    c.scene.add_quad({-1.2f, 1.8f, 0.5f}, {2, 0, 0}, {0, 0.2f, 1.5f}, c.scene.add_emitter({6, 5, 4}));
    c.scene.film().sky.color = {0.3f, 0.4f, 0.6f};
    c.scene.add_camera({0, 0.5f, 4}, {0, 0, 0}, 0.3f);
    return c;
}

}  // namespace

std::vector<NamedCase> material_cases() {
    return {{"MattUnderSun", under_sun<matt>},
            {"Dielectric02UnderSun", under_sun<rough<2>>},
            {"Dielectric05UnderSun", under_sun<rough<5>>},
            {"Dielectric10UnderSun", under_sun<rough<10>>},
            {"Metal02UnderSun", under_sun<metal<2>>},
            {"Metal05UnderSun", under_sun<metal<5>>},
            {"Metal10UnderSun", under_sun<metal<10>>},
            {"HalfMetalUnderSun", under_sun<half_metal>},
            {"Metal02InFurnace", furnace<2>},
            {"Metal05InFurnace", furnace<5>},
            {"Metal10InFurnace", furnace<10>},
            {"Matt", under_all<matt>},
            {"Dielectric02", under_all_by_chance<rough<2>>},
            {"Dielectric03", under_all_by_chance<rough<3>>},
            {"Dielectric05", under_all<rough<5>>},
            {"Dielectric10", under_all<rough<10>>},
            {"Metal02", under_all_by_chance<metal<2>>},
            {"Metal03", under_all_by_chance<metal<3>>},
            {"Metal05", under_all<metal<5>>},
            {"Metal10", under_all<metal<10>>},
            {"HalfMetal", under_all<half_metal>},
            {"SpecularGlossiness", under_all<glossiness>},
            {"ColorImage", under_all<color_image>},
            {"RoughnessImage", under_all_filtered<roughness_image>},
            {"NormalMap", under_all_filtered<normal_map>},
            {"VertexColors", vertex_colors},
            {"MetalBall", metal_ball},
            {"MattUnderRoundLamps", under_round_lamps<matt>},
            {"Dielectric02UnderRoundLamps", under_round_lamps<rough<2>>},
            {"Dielectric05UnderRoundLamps", under_round_lamps<rough<5>>},
            {"Metal02UnderRoundLamps", under_round_lamps<metal<2>>},
            {"Metal03UnderRoundLamps", under_round_lamps<metal<3>>},
            {"Metal05UnderRoundLamps", under_round_lamps<metal<5>>}};
}

}  // namespace render2mpeg::reference
