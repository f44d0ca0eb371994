#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "scene/animation_file/shapes.h"
#include "tests/hard_cases/hard_case.h"

namespace render2mpeg::test {
namespace {

/// A lit floor of another material than 0, whose look `change` decides.
SceneBuilder floor_of(const std::function<void(scene::Material&)>& change) {
    SceneBuilder b = floor_from_above();
    change(b.material(0));
    b.add_point_light({0, 2, 0}, 1);
    return b;
}

/// Closed, all of reflectance `albedo`, with a lamp of radiance 1 in the ceiling.
SceneBuilder closed_room(float albedo) {
    SceneBuilder b;
    b.add_box({-1, 0, -1}, {1, 2, 1}, b.add_material(glm::vec3(albedo)), true);
    b.add_quad({-0.5f, 1.99f, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter(glm::vec3(1)));
    b.add_camera({0, 1.9f, 0}, {0, 0, 0}, 0.9f);
    return b;
}

/// Sheets of one material, one above the other, between the camera and the lit floor.
SceneBuilder sheets(int count, const std::function<void(scene::Material&)>& change) {
    SceneBuilder b = floor_from_above();
    const int sheet = b.add_material(glm::vec3(1));
    b.material(sheet).double_sided = true;
    change(b.material(sheet));
    for (int i = 0; i < count; ++i)
        b.add_quad({-4, 0.5f + 0.003f * static_cast<float>(i), 4}, {8, 0, 0}, {0, 0, -8}, sheet);
    b.add_point_light({0, 2, 0}, 1);
    return b;
}

int clear_glass(SceneBuilder& b, float ior) {
    const int m = b.add_material(glm::vec3(1));
    scene::Material& glass = b.material(m);
    glass.transmission = 1;
    glass.roughness = 0;
    glass.ior = ior;
    glass.thickness = scene::Thickness::solid;
    return m;
}

/// A goblet with wine on a lit floor. The wine reaches so far into the wall of the bowl.
SceneBuilder goblet(double into) {
    SceneBuilder b;
    b.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, b.add_material(glm::vec3(0.5f)));
    const auto turned = [&](const std::vector<glm::dvec2>& outline, int material) {
        b.add_object(b.add_mesh(scene::lathe_mesh(outline, 48, 40, scene::TextureLayout::fit)), material);
    };
    turned({{0, 0.01},
            {0.4, 0.01},
            {0.4, 0.03},
            {0.05, 0.06},
            {0.05, 0.5},
            {0.3, 0.6},
            {0.5, 0.9},
            {0.4, 1.5},
            {0.37, 1.5},
            {0.47, 0.9},
            {0.28, 0.63},
            {0, 0.56}},
           clear_glass(b, 1.5f));
    const int wine = clear_glass(b, 1.34f);
    b.material(wine).attenuation_color = {0.9f, 0.2f, 0.2f};
    b.material(wine).attenuation_distance = 0.5f;
    turned({{0, 0.56 - into}, {0.28 + into, 0.63 - into}, {0.47 + into, 0.9}, {0, 0.9}}, wine);
    b.add_point_light({-1.5f, 3, -2}, 20);
    b.add_camera({0, 1.6f, 2.4f}, {0.2f, 0.5f, 0}, 0.9f);
    return b;
}

}  // namespace

std::vector<HardCase> material_cases() {
    return {
        of_side({"a closed room that absorbs nothing", "paths never end, their sum has no bound",
                 "taken as reflecting 99 %: finite, and said", [] { return closed_room(1); },
                 [](const Lit& film) {
                     // A power of pi over what absorbs: the lamp, black, of area 1, and 24 of walls that take 1 %.
                     EXPECT_NEAR(film.mean(), 1 / 1.24, 0.15);
                 }},
                16),
        of_side({"a surface that reflects more than it gets", "every bounce brightens",
                 "taken as reflecting all of it, with a note", [] { return closed_room(1.5f); },
                 [](const Lit& film) {
                     EXPECT_LT(film.mean(), 1.0);
                     ASSERT_FALSE(film.notes.empty());
                     EXPECT_NE(film.notes.front().find("clamped"), std::string::npos) << film.notes.front();
                 }},
                16),
        {"a room that reflects nothing", "probabilities of reflection are 0/0", "the lamp is seen, all else is black",
         [] { return closed_room(0); }, [](const Lit& film) { EXPECT_EQ(film.at(16, 16), glm::vec3(0)); }},
        {"a polished metal floor below its lamp", "the lobe of roughness 0 is a delta: infinite values, no area",
         "a mirror: it shows the black above it",
         [] { return floor_of([](scene::Material& m) { m.metallic = 1, m.roughness = 0; }); }},
        {"a gloss of roughness 0.01 below a lamp",
         "the lobe's peak is 1e8 and hides in no bound",
         "finite, and cut as finely as its peak needs",
         [] { return floor_of([](scene::Material& m) { m.ior = 1.5f, m.roughness = 0.01f; }); },
         nullptr,
         std::numeric_limits<float>::infinity(),
         {},
         {32, 32},
         1},
        {"emission that is no number",
         "NaN in every light point",
         "a line that names the material",
         [] { return floor_of([](scene::Material& m) { m.emission.x = NAN; }); },
         {},
         {},
         "material 0"},
        {"emission of 1e38", "sums over light points overflow", "taken as 1e30, with a note; the film shows white",
         [] { return floor_of([](scene::Material& m) { m.emission = glm::vec3(1e38f); }); },
         [](const Lit& film) {
             EXPECT_FALSE(film.notes.empty());
             EXPECT_EQ(film.decoded.front().y.at(16, 16), 235);
         }},
        {"sheets that are wholly transparent", "each stops the ray it does not change", "the floor as without them",
         [] {
             return sheets(24, [](scene::Material& m) {
                 m.alpha_mode = scene::AlphaMode::blend;
                 m.base_color.w = 0;
             });
         },
         [](const Lit& film) { expect_like(film, floor_of([](scene::Material&) {}), 0.02); }},
        {"forty sheets that are nearly transparent",
         "rays never reach an end",
         "an end of paths and a finite picture",
         [] {
             return sheets(40, [](scene::Material& m) {
                 m.alpha_mode = scene::AlphaMode::blend;
                 m.base_color.w = 0.01f;
             });
         },
         [](const Lit& film) { EXPECT_GT(film.mean(), 0.0); },
         1.0f,
         {},
         {8, 8},
         1},
        {"sheets cut out at the threshold", "alpha equal to the cutoff flickers", "alpha at the cutoff is there",
         [] {
             return sheets(1, [](scene::Material& m) {
                 m.alpha_mode = scene::AlphaMode::mask;
                 m.base_color.w = m.alpha_cutoff = 0.5f;
             });
         },
         [](const Lit& film) { EXPECT_GT(film.at(16, 16).y, 0.9f / std::numbers::pi_v<float> / 4); }},
        {"glass without refraction", "Fresnel's terms of index 1 are 0/0", "the floor as without it",
         [] { return sheets(1, [](scene::Material& m) { m.transmission = 1, m.roughness = 0, m.ior = 1; }); },
         [](const Lit& film) { EXPECT_GT(film.mean(), 0.0); }},
        {"glass of index 1e6",
         "reflectance rounds to 1, angles to 0",
         "taken as index 100, with a note",
         [] { return sheets(1, [](scene::Material& m) { m.transmission = 1, m.roughness = 0, m.ior = 1e6f; }); },
         [](const Lit& film) { EXPECT_FALSE(film.notes.empty()); },
         std::numeric_limits<float>::infinity(),
         {},
         {32, 32},
         1},
        {"a wine glass with wine",
         "five boundaries on a way, two of them touch; light that is focused has no bound",
         "light passes it, red where the wine is, and falls onto the floor",
         [] { return goblet(0.01); },
         [](const Lit& film) {
             EXPECT_TRUE(film.notes.empty());
             EXPECT_GT(film.statistics.caustic_photons, 0u);
             // Through the wine, and beside the glass.
             EXPECT_GT(film.at(14, 12).x, 1.5f * film.at(14, 12).y);
             EXPECT_NEAR(film.at(2, 24).x / film.at(2, 24).y, 1.0f, 0.05f);
         },
         std::numeric_limits<float>::infinity(),
         {},
         {32, 32},
         1},
        {"wine that ends where its glass begins",
         "which of two boundaries in one place comes first is up to rounding",
         "within a tenth of wine that reaches into its glass",
         [] { return goblet(0); },
         [](const Lit& film) {
             HardCase one;
             one.frames = 1;
             one.size = {16, 16};
             EXPECT_NEAR(film.mean() / lit(one, goblet(0.01), film.way).mean(), 1.0, 0.1);
         },
         std::numeric_limits<float>::infinity(),
         {},
         {16, 16},
         1},
        {"two mirrors that face each other",
         "a path that never ends",
         "it ends after some reflections",
         [] {
             SceneBuilder b;
             const int mirror = b.add_material(glm::vec3(1));
             b.material(mirror).metallic = 1;
             b.material(mirror).roughness = 0;
             b.add_quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, mirror);
             b.add_quad({1, -1, 1}, {-2, 0, 0}, {0, 2, 0}, mirror);
             b.film().sky.color = glm::vec3(1);
             b.add_camera({0, 0, 0}, {0.05f, 0.02f, -1});
             return b;
         },
         {},
         1.01f},
    };
}

}  // namespace render2mpeg::test
