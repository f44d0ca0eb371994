#include <gtest/gtest.h>

#include <numbers>

#include "core/color.h"
#include "tests/hard_cases/hard_case.h"

namespace render2mpeg::test {
namespace {

/// Radiance of a floor of reflectance 0.5 right below a lamp of intensity 1, 2 above it.
constexpr float below_the_lamp = 0.5f / std::numbers::pi_v<float> / 4;

/// Within what the tolerance of 2 % and pixels beside the middle leave.
void expect_near(const glm::vec3& value, float expected) {
    EXPECT_NEAR(value.y / expected, 1.0f, 0.035f);
}

void expect_black(const Lit& film) {
    EXPECT_EQ(film.brightest(), 0.0f);
}

SceneBuilder lamps(int count, float intensity) {
    SceneBuilder b = floor_from_above();
    for (int i = 0; i < count; ++i) b.add_point_light({0, 2, 0}, intensity);
    return b;
}

scene::Light spot(int node, float inner, float outer) {
    scene::Light light;
    light.kind = scene::LightKind::spot;
    light.node = node;
    light.inner_cone = inner;
    light.outer_cone = outer;
    return light;
}

/// A spot at the camera that looks down with it.
SceneBuilder spot_from_above(float inner, float outer) {
    SceneBuilder b = floor_from_above();
    b.add_light(spot(b.film().cameras.front().node, inner, outer));
    return b;
}

/// Two rooms side by side; the camera is in the first, a lamp in either.
SceneBuilder two_rooms(float here, float beyond) {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.5f));
    b.add_box({-2, 0, -2}, {2, 3, 2}, white, true);
    b.add_box({2.001f, 0, -2}, {6, 3, 2}, white, true);
    b.add_point_light({0, 2, 0}, here);
    if (beyond > 0) b.add_point_light({4, 2, 0}, beyond);
    b.add_camera({0, 2.9f, 0}, {0, 0, 0}, 0.9f);
    return b;
}

SceneBuilder sky_over_a_floor(float radiance) {
    SceneBuilder b = floor_from_above();
    b.film().sky.color = glm::vec3(radiance);
    return b;
}

}  // namespace

std::vector<HardCase> light_cases() {
    return {
        {"no light at all", "0/0 in every relative error, in mean intensities and in masking",
         "a black film, without a ray for light", [] { return lamps(0, 0); },
         [](const Lit& film) {
             expect_black(film);
             EXPECT_EQ(film.statistics.shadow_rays, 0u);
             EXPECT_LT(film.bytes, 4000u);
         }},
        {"a lamp of no intensity", "probabilities and cones of nothing are 0/0", "a black film",
         [] { return lamps(1, 0); }, expect_black},
        {"a lamp in the plane of the surface", "cosine 0 over distance 0", "it does not light that plane",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_point_light({0, 0, 0}, 1);
             return b;
         },
         expect_black},
        {"a lamp a millionth above a surface", "1 / d^2 reaches 1e12",
         "a spot smaller than a pixel, next to nothing elsewhere",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_point_light({0, 1e-6f, 0}, 1);
             return b;
         },
         [](const Lit& film) { EXPECT_LT(film.at(1, 1).y, 1e-5f); }},
        {"a thousand lamps in one place", "boxes without extent: no axis to split, endless depth, 0/0 in distances",
         "as one lamp of their sum", [] { return lamps(1000, 1e-3f); },
         [](const Lit& film) { expect_near(film.at(16, 16), below_the_lamp); }},
        {"a lamp of 1e-30", "intensities underflow on their way", "black for any display, and finite",
         [] { return lamps(1, 1e-30f); }, [](const Lit& film) { EXPECT_LT(film.brightest(), 1e-28f); }},
        {"a lamp of 1e12", "sums overflow, display codes run over", "the radiance it has; the film shows white",
         [] { return lamps(1, 1e12f); },
         [](const Lit& film) {
             expect_near(film.at(16, 16), 1e12f * below_the_lamp);
             EXPECT_EQ(film.decoded.front().y.at(16, 16), 235);
         }},
        {"a lamp beside a hidden one 1e12 times as bright",
         "sums in single precision lose the dim one, or all weight goes to the hidden one",
         "the room of the dim lamp is lit as if it were alone", [] { return two_rooms(1, 1e12f); },
         [](const Lit& film) {
             HardCase alone;
             const Lit dim = lit(alone, two_rooms(1, 0), film.way);
             EXPECT_GT(dim.mean(), 0.0);
             // Its bounced light has few of the photons that it has alone.
             EXPECT_NEAR(film.mean() / dim.mean(), 1.0, 0.1);
         }},
        {"a lamp of infinite intensity",
         "Inf - Inf",
         "a line that names the lamp",
         [] { return lamps(1, INFINITY); },
         {},
         {},
         "light 0"},
        {"a lamp whose intensity is no number",
         "NaN in every pixel",
         "a line that names the lamp",
         [] { return lamps(1, NAN); },
         {},
         {},
         "light 0"},
        {"a sun along the surface", "the cosine's sign is noise", "a surface it grazes stays black",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_sun({1, 0, 0}, 10);
             return b;
         },
         expect_black},
        {"a sun from below", "a negative cosine lights or darkens", "the floor's back is lit, its front is black",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_sun({0.1f, 1, 0}, 10);
             return b;
         },
         expect_black},
        {"a spot of 90 degrees", "the cone's cosine is 0 and no bound of it", "a lamp of half a sphere",
         [] { return spot_from_above(1.5f, 1.5707963f); },
         [](const Lit& film) { expect_near(film.at(16, 16), below_the_lamp); }},
        {"a spot with a sharp edge",
         "1 / (inner - outer) is infinite",
         "a line that names the lamp",
         [] { return spot_from_above(0.5f, 0.5f); },
         {},
         {},
         "its cone angles"},
        {"a spot of a thousandth of a degree",
         "cosines of inner and outer cone are the same number",
         "finite, and never brighter than a lamp for all directions",
         [] { return spot_from_above(0, 1.7e-5f); },
         {},
         1.1f * below_the_lamp},
        {"a lamp in the plane of the ceiling", "the end of the shadow ray meets the ceiling",
         "the floor is lit, nothing is speckled",
         [] {
             SceneBuilder b;
             const int white = b.add_material(glm::vec3(0.5f));
             b.add_box({-2, 0, -2}, {2, 2, 2}, white, true);
             b.add_quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter(glm::vec3(5)));
             b.add_camera({0, 1.9f, 0}, {0, 0, 0}, 0.9f);
             return b;
         },
         [](const Lit& film) {
             for (int x = 1; x < 31; ++x) EXPECT_GT(film.at(x, 16).y, 0.5f * film.at(16, 16).y) << x;
         }},
        {"a lamp that touches the floor", "points of lamp and floor coincide: d = 0 on both sides",
         "bright beside it, within what its radiance allows",
         [] {
             SceneBuilder b = floor_from_above(4);
             b.add_quad({0.3f, 0, 0.5f}, {0, 1, 0}, {0, 0, -1}, b.add_emitter(glm::vec3(3)));
             return b;
         },
         [](const Lit& film) { EXPECT_GT(film.mean(), 0.0); }, 3.0f},
        {"a lamp shut in a box", "light leaks where two surfaces meet", "outside it is black",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_box({-0.5f, 0.2f, -0.5f}, {0.5f, 1, 0.5f}, b.add_material(glm::vec3(0.5f)));
             b.add_quad({-0.2f, 0.6f, 0.2f}, {0.4f, 0, 0}, {0, 0, -0.4f}, b.add_emitter(glm::vec3(100)));
             return b;
         },
         expect_black},
        {"a lamp that shines the other way", "the back of a lamp counts as its front", "what is behind it is black",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_quad({-0.05f, 1.5f, 0.05f}, {0.1f, 0, 0}, {0, 0, -0.1f}, b.add_emitter(glm::vec3(10)));
             return b;
         },
         [](const Lit& film) { EXPECT_EQ(film.at(1, 1), glm::vec3(0)); }},
        {"lamps that share the room with 1e6 times brighter ones",
         "the choice of light points drops the dim ones' share", "the sum of both",
         [] {
             SceneBuilder b = lamps(1, 1);
             b.add_point_light({0, 2, 0}, 1e-6f);
             return b;
         },
         [](const Lit& film) { expect_near(film.at(16, 16), below_the_lamp); }},
        {"a sky of one colour over a floor", "a sky has no distance and no box",
         "reflectance times radiance in every pixel", [] { return sky_over_a_floor(2); },
         [](const Lit& film) {
             for (int x = 2; x < 30; x += 9) EXPECT_NEAR(film.at(x, 16).y, 1.0f, 0.05f) << x;
         }},
        {"a sky of 1e9", "squares of it overflow", "reflectance times radiance, and white in the film",
         [] { return sky_over_a_floor(1e9f); },
         [](const Lit& film) {
             EXPECT_NEAR(film.at(16, 16).y / 5e8f, 1.0f, 0.1f);  // white hides what it is off by
             EXPECT_EQ(film.decoded.front().y.at(16, 16), 235);
         }},
        {"a sky whose colour is no number",
         "NaN in every pixel",
         "a line that names the sky",
         [] { return sky_over_a_floor(NAN); },
         {},
         {},
         "sky"},
    };
}

}  // namespace render2mpeg::test
