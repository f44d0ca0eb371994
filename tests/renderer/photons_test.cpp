#include "renderer/lights/photons.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/surface/lobe_albedo.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

constexpr double pi_double = std::numbers::pi;

/// A closed white-ish room with a lamp.
SceneBuilder photon_room(float albedo) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 3, 5}, b.add_material(glm::vec3(albedo)), true);
    b.add_point_light({1.7f, 1.6f, 2.1f}, 10.0f, {1.0f, 0.5f, 0.25f});
    return b;
}

glm::dvec3 power(const std::vector<LightPoint>& vpls) {
    glm::dvec3 sum(0);
    for (const LightPoint& v : vpls) sum += glm::dvec3(v.intensity) * pi_double;
    return sum;
}

TEST(Photons, CarryAllReflectedPowerOfAClosedRoom) {
    // Light of flux F in a closed room of reflectance r leaves surfaces, over bounces 1..n, with F (r + r^2 + ... +
    // r^n).
    for (const float albedo : {0.3f, 0.7f}) {
        LitStage stage(photon_room(albedo));
        const auto lights = stage.direct_points(16, 1);
        for (const int bounces : {1, 3}) {
            const PhotonResult r = trace_photons(stage.posed_scene(), lights, {1, 4000, bounces});
            double expected = 0;
            for (int k = 1; k <= bounces; ++k) expected += std::pow(albedo, k);
            expected *= 4 * pi_double * 10;
            const glm::dvec3 sum = power(r.vpls);
            const double tint[] = {1, 0.5, 0.25};
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(sum[k] / (expected * tint[k]), 1.0, bounces == 1 ? 1e-4 : 0.03) << albedo << " " << bounces;
        }
    }
}

TEST(Photons, CarryTheWholeGeometricSeriesSlow) {
    // However many bounces: F (r + r^2 + ...) = F r / (1 - r).
    for (const float albedo : {0.7f, 0.9f, 0.95f, 0.99f}) {
        LitStage stage(photon_room(albedo));
        const PhotonResult r = trace_photons(stage.posed_scene(), stage.direct_points(16, 1), {1, 20000, 0});
        const double expected = 4 * pi_double * 10 * albedo / (1 - albedo);
        EXPECT_NEAR(power(r.vpls).x / expected, 1.0, 0.02) << albedo;
        EXPECT_NEAR(r.landed * albedo / core::luminance(glm::vec3(power(r.vpls))), 1.0, 1e-3) << albedo;
        EXPECT_LT(r.lost / r.landed, 1e-6) << albedo;
    }
}

TEST(Photons, EndEvenWhereSurfacesReflectEverything) {
    LitStage stage(photon_room(1.0f));
    const PhotonResult r = trace_photons(stage.posed_scene(), stage.direct_points(16, 1), {1, 2000, 0});
    for (const LightPoint& v : r.vpls) EXPECT_TRUE(std::isfinite(v.intensity.x));
    EXPECT_NEAR(power(r.vpls).x / (4 * pi_double * 10 / (1 - largest_albedo)), 1.0, 0.1);
    EXPECT_NEAR(r.lost / r.landed, 1 - largest_albedo, 1e-3) << "what the surfaces would have passed on";
}

TEST(Photons, LeaveNothingInABlackOrEmptyRoom) {
    LitStage black(photon_room(0.0f));
    EXPECT_TRUE(trace_photons(black.posed_scene(), black.direct_points(16, 1), {1, 500, 8}).vpls.empty());
    LitStage lit(photon_room(0.5f));
    EXPECT_TRUE(trace_photons(lit.posed_scene(), {}, {1, 500, 8}).vpls.empty());
    EXPECT_EQ(paths_for(lit.posed_scene(), {}, 1000, 8), 0u);
    EXPECT_EQ(paths_for(black.posed_scene(), black.direct_points(16, 1), 1000, 8), 0u);
}

TEST(Photons, AreCountedToLeaveAsManyVplsAsWanted) {
    for (const float albedo : {0.1f, 0.5f, 0.9f}) {
        LitStage stage(photon_room(albedo));
        const auto lights = stage.direct_points(16, 1);
        const std::uint64_t paths = paths_for(stage.posed_scene(), lights, 2000, 8);
        const auto left = static_cast<double>(trace_photons(stage.posed_scene(), lights, {1, paths, 8}).vpls.size());
        EXPECT_NEAR(left / 2000, 1.0, 0.1);
    }
}

TEST(Photons, AreTheSameForAnyNumberOfThreads) {
    LitStage stage(photon_room(0.7f));
    const auto lights = stage.direct_points(16, 1);
    std::vector<LightPoint> one, two;
    {
        const parallel::ThreadLimit limit(1);
        one = trace_photons(stage.posed_scene(), lights, {1, 1000, 8}).vpls;
    }
    {
        const parallel::ThreadLimit limit(2);
        two = trace_photons(stage.posed_scene(), lights, {1, 1000, 8}).vpls;
    }
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].position, two[i].position);
        EXPECT_EQ(one[i].intensity, two[i].intensity);
    }
}

TEST(Photons, KeepTheirPathsWhereAnotherPartOfTheSceneMoves) {
    SceneBuilder b = photon_room(0.6f);
    const int ball = b.add_sphere({3.4f, 0.5f, 4.4f}, 0.3f, b.add_material(), 8);
    b.move_object(ball, {{3.4f, 0.5f, 4.4f}, {3.4f, 0.5f, 4.2f}});
    LitStage before(b, 0), after(b, 1);
    const auto one = trace_photons(before.posed_scene(), before.direct_points(16, 1), {1, 1000, 1}).vpls;
    const auto two = trace_photons(after.posed_scene(), after.direct_points(16, 1), {1, 1000, 1}).vpls;
    std::size_t same = 0;
    for (const LightPoint& v : one)
        for (const LightPoint& w : two) same += v.position == w.position && v.intensity == w.intensity ? 1 : 0;
    EXPECT_GT(same, one.size() * 95 / 100);
    EXPECT_LT(same, one.size());
}

TEST(Photons, PassThroughWhatIsNotThere) {
    // A half transparent sheet before the lamp lets half of the photons through to the wall.
    SceneBuilder b;
    b.add_quad({-50, -50, -2}, {100, 0, 0}, {0, 100, 0}, b.add_material(glm::vec3(0.5f)));
    const int sheet = b.add_material(glm::vec3(0.0f));
    b.material(sheet).alpha_mode = scene::AlphaMode::blend;
    b.material(sheet).base_color.a = 0.25f;
    b.add_quad({-40, -40, -1}, {80, 0, 0}, {0, 80, 0}, sheet);
    scene::Light spot;
    spot.kind = scene::LightKind::spot;
    spot.intensity = 1;
    spot.inner_cone = 0.1f;
    spot.outer_cone = 0.3f;
    spot.node = 0;
    b.add_light(spot);  // at the origin, along -z
    LitStage stage(b);
    const auto lights = stage.direct_points(16, 1);
    const auto vpls = trace_photons(stage.posed_scene(), lights, {1, 20000, 1}).vpls;
    // Flux of the cone: integral of clamp((c - co) / (ci - co))^2 over its solid angle.
    const double ci = std::cos(0.1), co = std::cos(0.3);
    const double flux = 2 * pi_double * ((1 - ci) + (ci - co) / 3);
    EXPECT_NEAR(power(vpls).x / (flux * 0.75 * 0.5), 1.0, 0.02);
}

}  // namespace
}  // namespace render2mpeg::renderer
