#include "renderer/surface/dielectric.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/color.h"
#include "glass_stage.h"

namespace render2mpeg::test {
namespace {

using renderer::Band;
using renderer::dielectric_reflectance;
using renderer::refracted;

constexpr float degree = std::numbers::pi_v<float> / 180;

glm::vec3 falling(float degrees) {
    return {std::sin(degrees * degree), -std::cos(degrees * degree), 0};
}

TEST(Dielectric, ReflectsFourPercentAtNormalIncidence) {
    EXPECT_NEAR(dielectric_reflectance(1, 1.5f), 0.04f, 1e-6f);
    EXPECT_NEAR(dielectric_reflectance(1, 1 / 1.5f), 0.04f, 1e-6f);
    EXPECT_EQ(dielectric_reflectance(0, 1.5f), 1.0f);
    EXPECT_LT(dielectric_reflectance(0.3f, 1.0f), 1e-9f);
}

TEST(Dielectric, ReflectsHalfOfOnePolarisationAtBrewstersAngle) {
    // r_p is 0 there, so that all that is reflected is half of r_s^2 = ((n^2 - 1) / (n^2 + 1))^2.
    const float n = 1.5f, cosine = std::cos(std::atan(n)), s = (n * n - 1) / (n * n + 1);
    EXPECT_NEAR(dielectric_reflectance(cosine, n), 0.5f * s * s, 1e-5f);
}

TEST(Dielectric, ReflectsAllBeyondTheCriticalAngle) {
    const float critical = std::asin(1 / 1.5f) / degree;
    EXPECT_NEAR(critical, 41.810f, 1e-3f);
    EXPECT_EQ(dielectric_reflectance(std::cos((critical + 0.01f) * degree), 1 / 1.5f), 1.0f);
    EXPECT_EQ(refracted(falling(critical + 0.01f), {0, 1, 0}, 1 / 1.5f), glm::vec3(0));
    // Continuous below: the root of a hundredth of a degree is a tenth.
    const float just_below = dielectric_reflectance(std::cos((critical - 1e-4f) * degree), 1 / 1.5f);
    EXPECT_GT(just_below, 0.97f);
    EXPECT_LT(just_below, 1.0f);
}

TEST(Dielectric, BendsBySnellsLawAndBack) {
    for (const float n : {1.1f, 1.33f, 1.5f, 2.4f})
        for (float angle = 0; angle < 89; angle += 4) {
            const glm::vec3 in = falling(angle), out = refracted(in, {0, 1, 0}, n);
            EXPECT_NEAR(n * out.x, in.x, 2e-6f);
            EXPECT_NEAR(glm::length(out), 1, 1e-6f);
            const glm::vec3 back = refracted(-out, {0, -1, 0}, 1 / n);
            // Cosines err by more than sines do at grazing angles.
            EXPECT_LT(glm::length(back + in), 1e-5f / std::max(-in.y, 0.05f));
            EXPECT_NEAR(dielectric_reflectance(-in.y, n), dielectric_reflectance(-out.y, 1 / n), 2e-5f / -in.y);
        }
}

TEST(Dielectric, NeighboursBendAsTheirOwnDirectionsSay) {
    const glm::vec3 n(0, 1, 0);
    const float step = 1e-3f;
    for (const float index : {1.5f, 1 / 1.5f})
        for (const float angle : {5.0f, 20.0f, 38.0f}) {
            const glm::vec3 d = falling(angle);
            const glm::vec3 change = step * glm::normalize(glm::vec3(-d.y, d.x, 0.5f));
            const glm::vec3 turn = step * glm::vec3(0.3f, 0, -0.6f);
            const glm::vec3 neighbour = refracted(glm::normalize(d + change), glm::normalize(n + turn), index);
            const glm::vec3 expected = neighbour - refracted(d, n, index);
            EXPECT_LT(glm::length(renderer::refracted_change(d, change, n, turn, index) - expected), 0.03f * step)
                << index << " " << angle;
        }
}

TEST(Dielectric, MediaTakeLightByTheWay) {
    scene::Material m;
    m.attenuation_color = {0.5f, 1, 0};
    m.attenuation_distance = 2;
    const renderer::Medium medium = renderer::medium_of(m);
    EXPECT_NEAR(medium.passes(2).x, 0.5f, 1e-6f);
    EXPECT_NEAR(medium.passes(4).x, 0.25f, 1e-6f);
    EXPECT_EQ(medium.passes(4).y, 1.0f);
    EXPECT_EQ(medium.passes(1e-3f).z, 0.0f);
    EXPECT_EQ(medium.passes(0).z, 1.0f);
}

/// A prism whose edges run along z; faces meet at the top by this angle.
scene::Mesh prism(float degrees) {
    scene::Mesh mesh;
    const float half = std::tan(0.5f * degrees * degree);
    for (const float z : {-5.0f, 5.0f})
        for (const glm::vec2 p : {glm::vec2(0, 1), glm::vec2(-half, 0), glm::vec2(half, 0)})
            mesh.positions.emplace_back(p, z);
    mesh.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    return mesh;
}

float deviation(float n, float dispersion, Band band) {
    SceneBuilder b;
    const int glass = add_glass(b, n);
    b.material(glass).dispersion = dispersion;
    b.add_object(b.add_mesh(prism(60)), glass);
    b.add_camera({0, 0, 9}, {0, 0, 0});
    b.add_point_light({0, 9, 0}, 1);
    const Stage stage(b);
    // At minimum deviation the ray within runs level.
    const float angle = std::asin(n * 0.5f);  // sin(A / 2) = 1 / 2
    // The left face's normal points up to the left, 30 degrees above level.
    const float up = angle - 30 * degree;
    const glm::vec3 in(std::cos(up), std::sin(up), 0);
    const glm::vec3 entry(-0.5f * std::tan(30 * degree), 0.5f, 0);
    const PassedRay out = pass_glass(stage, entry - 2.0f * in, in, band);
    EXPECT_EQ(out.boundaries, 2);
    return std::acos(std::clamp(glm::dot(in, out.direction), -1.0f, 1.0f)) / degree;
}

TEST(SolidGlass, PrismDeviatesByItsMinimum) {
    EXPECT_NEAR(deviation(1.5f, 0, Band::all), 37.181f, 2e-3f);
}

TEST(SolidGlass, PrismSplitsColours) {
    // Crown glass, V = 59: indices 1.5168 -+ 0.00438.
    const float dispersion = 20.0f / 59;
    const float red = deviation(1.5f, dispersion, Band::red), blue = deviation(1.5f, dispersion, Band::blue);
    EXPECT_NEAR(red, 36.814f, 0.01f);
    EXPECT_NEAR(blue, 37.548f, 0.01f);
}

TEST(SolidGlass, SlabShiftsAndKeepsTheDirection) {
    SceneBuilder b;
    b.add_box({-50, -1, -50}, {50, 0, 50}, add_glass(b));
    b.add_camera({0, 5, 9}, {0, 0, 0});
    b.add_point_light({0, 9, 0}, 1);
    const Stage stage(b);
    for (const float angle : {10.0f, 45.0f, 75.0f}) {
        const glm::vec3 in = falling(angle);
        const PassedRay out = pass_glass(stage, -3.0f * in, in);
        ASSERT_EQ(out.boundaries, 2);
        EXPECT_LT(glm::length(out.direction - in), 1e-5f);
        const float inside = std::asin(std::sin(angle * degree) / 1.5f);
        const float shift = std::sin(angle * degree - inside) / std::cos(inside);
        const glm::vec3 across = out.origin - glm::dot(out.origin, in) * in;
        EXPECT_NEAR(glm::length(across), shift, 1e-4f);
    }
}

TEST(SolidGlass, BallFocusesAtOneAndAHalfRadii) {
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, add_glass(b), 192);
    b.add_camera({0, 0, 9}, {0, 0, 0});
    b.add_point_light({0, 9, 0}, 1);
    const Stage stage(b);
    const float h = 0.05f;
    const PassedRay out = pass_glass(stage, {-3, h, 0.003f}, {1, 0, 0});
    ASSERT_EQ(out.boundaries, 2);
    const float focus = out.origin.x - out.origin.y * out.direction.x / out.direction.y;
    EXPECT_NEAR(focus, 1.5f, 0.01f);
}

TEST(SolidGlass, BallPassesItsStraightShare) {
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, add_glass(b), 96);
    b.add_camera({0, 0, 9}, {0, 0, 0});
    b.add_point_light({0, 9, 0}, 1);
    const Stage stage(b);
    double sum = 0;
    const int rings = 400;
    for (int i = 0; i < rings; ++i) {
        const float r = std::sqrt((static_cast<float>(i) + 0.5f) / rings), phi = 2.39996f * static_cast<float>(i);
        const PassedRay out = pass_glass(stage, {r * std::cos(phi), r * std::sin(phi), 3}, {0, 0, -1});
        if (out.boundaries == 2) sum += static_cast<double>(out.share.x);
    }
    EXPECT_NEAR(sum / rings, 0.8355, 0.004);
}

TEST(SolidGlass, LiquidTouchesItsGlassWithoutAirBetween) {
    // A block of glass whose upper half is liquid that reaches a little into the lower.
    SceneBuilder b;
    b.add_box({-9, -2, -9}, {9, -1, 9}, add_glass(b, 1.5f));
    b.add_box({-9, -1.01f, -9}, {9, 0, 9}, add_glass(b, 1.33f));
    b.add_camera({0, 5, 9}, {0, 0, 0});
    b.add_point_light({0, 9, 0}, 1);
    const Stage stage(b);
    const glm::vec3 in = falling(40);
    const PassedRay out = pass_glass(stage, -3.0f * in, in);
    EXPECT_LT(glm::length(out.direction - in), 1e-5f);
    const auto passes = [](float from, float to, float angle) {
        return 1 - dielectric_reflectance(std::cos(angle), to / from);
    };
    const float a = 40 * degree, water = std::asin(std::sin(a) / 1.33f), glass = std::asin(std::sin(a) / 1.5f);
    const float share = passes(1, 1.33f, a) * passes(1.33f, 1.5f, water) * passes(1.5f, 1, glass);
    EXPECT_NEAR(out.share.x, share, 1e-4f);
}

TEST(SolidGlass, OfIndexOneIsNotThere) {
    SceneBuilder with, without;
    for (SceneBuilder* b : {&with, &without}) {
        b->add_quad({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, b->add_emitter({1, 0.5f, 0.2f}));
        b->add_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
    }
    with.add_sphere({0, 0, 0}, 1, add_glass(with, 1.0f), 24);
    Stage a(with), b(without);
    const renderer::Frame seen = a.see(4), plain = b.see(4);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x)
            EXPECT_LT(glm::length(seen.emitted.at(x, y) - plain.emitted.at(x, y)), 1e-5f) << x << " " << y;
}

TEST(SolidGlass, IsInvisibleInAnEvenLight) {
    // What is lost is what ways end with below the least bound of eye_path.cpp, half a percent each.
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, add_glass(b), 48);
    b.add_box({1.2f, -1, -1}, {2.2f, 1, 1}, add_glass(b, 1.33f));
    b.film().sky.color = {1, 1, 1};
    b.add_camera({0.5f, 0.3f, 6}, {0.5f, 0, 0}, 0.6f);
    Stage stage(b, 64, 64);
    const renderer::Frame seen = stage.see(1);
    double sum = 0;
    float least = 2, most = 0;
    for (const glm::vec3& light : seen.emitted.values()) {
        const float l = core::luminance(light);
        sum += static_cast<double>(l);
        least = std::min(least, l);
        most = std::max(most, l);
    }
    EXPECT_GT(sum / (64 * 64), 0.995);
    EXPECT_LE(most, 1.0001f);
    EXPECT_GT(least, 0.85f);
}

TEST(SolidGlass, TakesLightByItsThickness) {
    SceneBuilder b;
    const int glass = add_glass(b);
    b.material(glass).attenuation_color = {0.5f, 0.25f, 1};
    b.material(glass).attenuation_distance = 1;
    b.add_box({-9, -9, -2}, {9, 9, 0}, glass);
    b.add_quad({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, b.add_emitter({1, 1, 1}));
    b.add_camera({0, 0, 5}, {0, 0, 0}, 0.1f);
    Stage stage(b, 16, 16);
    const glm::vec3 light = stage.see(1).emitted.at(8, 8);
    const float clear = light.z;
    EXPECT_NEAR(clear, 0.96f * 0.96f, 0.01f);
    EXPECT_NEAR(light.x / clear, 0.25f, 0.01f);
    EXPECT_NEAR(light.y / clear, 0.0625f, 0.01f);
}

TEST(SolidGlass, HasNoAirInside) {
    // A pane of index 1 in fog: 3 of air, 2 of glass, 3 of air, and a wall.
    SceneBuilder b;
    b.add_box({-90, -90, 0}, {90, 90, 2}, add_glass(b, 1.0f));
    b.add_quad({-90, -90, -3}, {180, 0, 0}, {0, 180, 0}, b.add_emitter({1, 1, 1}));
    b.add_camera({0, 0, 5}, {0, 0, 0}, 0.01f);
    b.film().fog.visibility = 30;
    Stage stage(b, 16, 16);
    const renderer::Frame seen = stage.see(1);
    constexpr float sigma = 3.0f / 30;
    float light = 0;
    for (const renderer::AirSpan& span : seen.air.front().straight)
        if (span.pixel == 8 * 16 + 8) light += span.weight.y * -std::expm1(-sigma * span.distance);
    EXPECT_NEAR(light, -std::expm1(-6 * sigma), 1e-3f);
    EXPECT_NEAR(seen.emitted.at(8, 8).y, std::exp(-6 * sigma), 1e-3f);
}

TEST(SolidGlass, KnowsThatTheEyeIsInside) {
    SceneBuilder b;
    const int glass = add_glass(b);
    b.material(glass).attenuation_color = {0.5f, 1, 1};
    b.material(glass).attenuation_distance = 1;
    b.add_box({-9, -9, -2}, {9, 9, 9}, glass);
    b.add_quad({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, b.add_emitter({1, 1, 1}));
    b.add_camera({0, 0, 1}, {0, 0, -3}, 0.1f);
    Stage stage(b, 16, 16);
    const glm::vec3 light = stage.see(1).emitted.at(8, 8);
    EXPECT_NEAR(light.y, 0.96f, 0.005f);
    EXPECT_NEAR(light.x / light.y, 0.125f, 0.005f);
}

}  // namespace
}  // namespace render2mpeg::test
