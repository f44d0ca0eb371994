#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/base/area_lamp.h"
#include "renderer/lights/area_lamps.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::LitStage;
using test::SceneBuilder;

constexpr double pi = std::numbers::pi;

/// Irradiance of a parallelogram of radiance 1, by the midpoints of n x n cells.
double by_quadrature(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, glm::dvec3 place, glm::dvec3 normal, int n) {
    const glm::dvec3 across = glm::cross(u, v), lamp_normal = glm::normalize(across);
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const glm::dvec3 d = corner + (i + 0.5) / n * u + (j + 0.5) / n * v - place;
            const double cosine = glm::dot(d, normal), at_lamp = std::abs(glm::dot(d, lamp_normal));
            if (cosine > 0) sum += cosine * at_lamp / (glm::dot(d, d) * glm::dot(d, d));
        }
    return sum * glm::length(across) / (n * n);
}

TEST(PolygonIrradiance, IsTheIntegralOverThePolygon) {
    const glm::vec3 corner{-0.4f, 1, -0.3f}, u{0.9f, 0.1f, 0}, v{0.1f, 0, 0.8f};
    const std::vector<glm::vec3> corners{corner, corner + u, corner + u + v, corner + v};
    const glm::vec3 places[] = {{0, 0, 0}, {2, 0.5f, -1}, {0.1f, 0.9f, 0.2f}, {-3, -1, 4}};
    const glm::vec3 normals[] = {{0, 1, 0}, {1, 0, 0}, {-0.6f, 0.8f, 0}, {0.3f, 0.2f, -0.9327379f}};
    for (const glm::vec3& place : places)
        for (const glm::vec3& normal : normals) {
            const double expected = by_quadrature(corner, u, v, place, normal, 1000);
            EXPECT_NEAR(polygon_irradiance(corners, place, normal), expected, 1e-4 * expected + 2e-6);
        }
}

TEST(PolygonIrradiance, HasNoneFromBelowNorInItsPlaneAndAtMostAWholeSkys) {
    const std::vector<glm::vec3> corners{{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}};
    EXPECT_EQ(polygon_irradiance(corners, {0, 0, 0}, {0, -1, 0}), 0.0);
    EXPECT_NEAR(polygon_irradiance(corners, {3, 1, 0}, {0, 1, 0}), 0.0, 1e-12);
    EXPECT_NEAR(polygon_irradiance(corners, {0, 1 - 1e-6f, 0}, {0, 1, 0}), pi, 1e-5);
    EXPECT_LE(polygon_irradiance(corners, {1, 1, 1}, {0, 1, 0}), pi);
    EXPECT_TRUE(std::isfinite(polygon_irradiance(corners, {1, 1, 1}, {0, 1, 0})));
    const std::vector<glm::vec3> needle{{0, 1, 0}, {1, 1, 0}, {0.5f, 1, 0}};
    EXPECT_NEAR(polygon_irradiance(needle, {0, 0, 0}, {0, 1, 0}), 0.0, 1e-9);
}

TEST(ConeIrradiance, IsTheIntegralOverTheConeAboveTheHorizon) {
    for (const double sigma : {0.01, 0.3, 1.0, pi / 2})
        for (const double theta : {0.0, 0.5, 1.2, pi / 2, 1.8, 2.5}) {
            // Midpoints of rings and sectors about the axis, at theta from the normal.
            constexpr int rings = 400, sectors = 400;
            double sum = 0;
            for (int r = 0; r < rings; ++r)
                for (int s = 0; s < sectors; ++s) {
                    const double low = 1 - std::cos(sigma), cosine = 1 - low * (r + 0.5) / rings;
                    const double sine = std::sqrt(1 - cosine * cosine), turn = 2 * pi * (s + 0.5) / sectors;
                    sum += std::max(0.0, cosine * std::cos(theta) + sine * std::cos(turn) * std::sin(theta)) * 2 * pi *
                           low / (rings * sectors);
                }
            const double sine = std::sin(sigma);
            EXPECT_NEAR(cone_irradiance(std::cos(theta), sine * sine), sum, 1e-4 * sum + 1e-5) << sigma << " " << theta;
        }
}

TEST(ConvexOutline, IsFoundInFlatConvexMeshesAlone) {
    EXPECT_EQ(convex_outline(SceneBuilder::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0})).size(), 4u);
    // Two quads side by side are one: the seam's corners lie on straight edges.
    scene::Mesh two = SceneBuilder::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    SceneBuilder::append(two, SceneBuilder::quad({1, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    EXPECT_EQ(convex_outline(two).size(), 4u);
    // An L, a box, two sheets apart, and a sheet that is bent.
    scene::Mesh corner = two;
    SceneBuilder::append(corner, SceneBuilder::quad({0, 1, 0}, {1, 0, 0}, {0, 1, 0}));
    EXPECT_TRUE(convex_outline(corner).empty());
    EXPECT_TRUE(convex_outline(SceneBuilder::box({0, 0, 0}, {1, 1, 1}, false)).empty());
    scene::Mesh apart = SceneBuilder::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    SceneBuilder::append(apart, SceneBuilder::quad({3, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    EXPECT_TRUE(convex_outline(apart).empty());
    scene::Mesh bent = SceneBuilder::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    SceneBuilder::append(bent, SceneBuilder::quad({1, 0, 0}, {1, 0, 0.1f}, {0, 1, 0}));
    EXPECT_TRUE(convex_outline(bent).empty());
}

/// A floor at y = 0 with a reflectance of 0.5, seen from above; no bounce.
SceneBuilder floor_of(float side = 10) {
    SceneBuilder b;
    b.add_quad({-side / 2, 0, side / 2}, {side, 0, 0}, {0, 0, -side}, b.add_material(glm::vec3(0.5f)));
    b.add_camera({0, 8, 0.01f}, {0, 0, 0}, 0.5f);
    return b;
}

/// How bright the pixels of a floor are over what `irradiance` says at their places, at least and at most.
template <class Irradiance>
std::pair<double, double> against(FilmStage& stage, const core::ToleranceMap& tolerance, const Irradiance& irradiance) {
    const scene::Snapshot world = stage.at(0);
    const Frame seen = stage.renderer().look(world);
    const core::Radiance r = stage.renderer().light(world, seen, {tolerance}).radiance;
    double low = 1e9, high = 0;
    for (int y = 0; y < r.combined.height(); ++y)
        for (int x = 0; x < r.combined.width(); ++x) {
            const auto p = scene::carry(seen.visible.address.at(x, y), world);
            if (!p || p->y != 0 || seen.visible.address.at(x, y).object != 0) continue;
            const double share = r.combined.at(x, y).x / (0.5 / pi * irradiance(glm::dvec3(*p)));
            low = std::min(low, share);
            high = std::max(high, share);
        }
    return {low, high};
}

Settings without_bounces() {
    Settings settings = test::small_frame();
    settings.vpls = 0;
    return settings;
}

TEST(AreaLamps, AreExactWhereNothingIsInTheWay) {
    const glm::vec3 corner{-0.5f, 1, -0.25f}, u{1, 0, 0}, v{0, 0, 0.5f};
    for (const auto& tolerance : {core::ToleranceMap::reference(), core::ToleranceMap::uniform(24, 24, {0, 0.02f})}) {
        SceneBuilder panel = floor_of();
        panel.add_quad(corner, u, v, panel.add_emitter(glm::vec3(3)));
        FilmStage of_panel(panel, without_bounces());
        const auto flat = against(of_panel, tolerance, [&](glm::dvec3 p) {
            return 3 * by_quadrature(corner, u, v, p, {0, 1, 0}, 200);
        });
        EXPECT_NEAR(flat.first, 1, 2e-4);
        EXPECT_NEAR(flat.second, 1, 2e-4);

        SceneBuilder ball = floor_of();
        ball.add_sphere({0.2f, 1, 0}, 0.3f, ball.add_emitter(glm::vec3(2)), 24);
        FilmStage of_ball(ball, without_bounces());
        // The mesh is inscribed: as bright as a sphere of its area.
        const auto round = against(of_ball, tolerance, [](glm::dvec3 p) {
            const glm::dvec3 d = glm::dvec3(0.2, 1, 0) - p;
            return 2 * pi * 0.09 / glm::dot(d, d) * d.y / glm::length(d);
        });
        EXPECT_GT(round.first, 0.99);
        EXPECT_LT(round.second, 1.0);
        EXPECT_LT(round.second - round.first, 1e-4) << "no noise";
    }
}

/// Root mean square, over pixels that the shadow's edge crosses, of the sun's share there less its true one.
double error_at_edge(int samples, bool cached, const core::ToleranceMap& tolerance) {
    // Straight above the half plane that lies left of x = 0.2 z + 0.03.
    SceneBuilder b = floor_of();
    b.film().cameras.clear();
    b.add_camera({0.9f, 1.2f, 0.01f}, {0, 0, 0}, 0.9f);
    b.add_quad({-50 - 10 + 0.03f, 2, -50}, {50, 0, 0}, {20, 0, 100}, b.add_material(glm::vec3(0)));
    b.add_sun({0, -1, 0}, 2);
    Settings settings = without_bounces();
    settings.samples = samples;
    if (cached) settings.cache = CacheUse::on;
    FilmStage stage(b, settings);
    const scene::Snapshot world = stage.at(0);
    const Frame seen = stage.renderer().look(world);
    const core::Radiance r = stage.renderer().light(world, seen, {tolerance}).radiance;
    double squares = 0, pixels = 0;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 24; ++x) {
            double lit = 0;
            constexpr int fine = 16;
            for (int i = 0; i < fine * fine; ++i) {
                const glm::vec2 place(static_cast<float>(x) + (static_cast<float>(i % fine) + 0.5f) / fine,
                                      static_cast<float>(y) + (static_cast<float>(i / fine) + 0.5f) / fine);
                const scene::Ray ray = world.camera.ray_through(place);
                const glm::vec3 p = ray.origin - ray.origin.y / ray.direction.y * ray.direction;
                lit += p.x > 0.2f * p.z + 0.03f ? 1.0 / (fine * fine) : 0.0;
            }
            if (lit < 0.02 || lit > 0.98 || seen.visible.address.at(x, y).object != 0) continue;
            const double error = r.combined.at(x, y).x / (2 * 0.5 / pi) - lit;
            squares += error * error;
            pixels += 1;
        }
    EXPECT_GT(pixels, 10);
    return std::sqrt(squares / pixels);
}

TEST(ShadowEdges, OfSunsWithoutSizeAreSmoothWithinPixels) {
    for (const auto& tolerance : {core::ToleranceMap::reference(), core::ToleranceMap::uniform(24, 24, {0, 0.02f})})
        for (const bool cached : {false, true}) {
            EXPECT_GT(error_at_edge(1, cached, tolerance), 0.2);
            EXPECT_LT(error_at_edge(4, cached, tolerance), 0.15);
        }
}

TEST(SoftSun, HasThePenumbraOfADiscBehindAnEdge) {
    // Straight above a half plane at this height whose edge runs along z through x = 0: a disc cut by a straight line.
    constexpr double half_angle = 0.1, height = 2;
    SceneBuilder b = floor_of();
    b.film().cameras.clear();
    b.add_camera({0.9f, 1.2f, 0.01f}, {0, 0, 0}, 0.9f);
    b.add_quad({-50, height, 50}, {50, 0, 0}, {0, 0, -100}, b.add_material(glm::vec3(0)));
    b.add_sun({0, -1, 0}, 2);
    b.film().lights.back().angle = half_angle;
    FilmStage stage(b, without_bounces());
    const scene::Snapshot world = stage.at(0);
    const Frame seen = stage.renderer().look(world);
    for (const auto& tolerance : {core::ToleranceMap::reference(), core::ToleranceMap::uniform(24, 24, {0, 0.02f})}) {
        const core::Radiance r = stage.renderer().light(world, seen, {tolerance}).radiance;
        const double allowed = tolerance.is_reference() ? 0.01 : 0.02;
        int in_part = 0, over = 0, seen_pixels = 0;
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 24; ++x) {
                const auto p = scene::carry(seen.visible.address.at(x, y), world);
                if (!p || seen.visible.address.at(x, y).object != 0) continue;
                const double u = std::clamp(p->x / height / std::tan(half_angle), -1.0, 1.0);
                const double visible = (std::acos(-u) + u * std::sqrt(1 - u * u)) / pi;
                const double error = std::abs(r.combined.at(x, y).x / (2 * 0.5 / pi) - visible);
                EXPECT_LT(error, tolerance.is_reference() ? allowed : 2 * allowed) << p->x;
                over += error > allowed ? 1 : 0;
                ++seen_pixels;
                in_part += visible > 0.05 && visible < 0.95 ? 1 : 0;
            }
        EXPECT_GT(in_part, 20);
        EXPECT_LE(over, seen_pixels / 100) << "a tolerance holds for 99 of 100 pixels";
    }
}

TEST(SoftSun, IsAsBrightAsAPointWhereNothingIsInTheWay) {
    double bright[2];
    for (const bool soft : {false, true}) {
        SceneBuilder b = floor_of();
        b.add_sun({0.3f, -1, 0.2f}, 2);
        if (soft) b.film().lights.back().angle = 0.2f;
        FilmStage stage(b, without_bounces());
        const scene::Snapshot world = stage.at(0);
        const Frame seen = stage.renderer().look(world);
        const core::Radiance r = stage.renderer().light(world, seen, {core::ToleranceMap::reference()}).radiance;
        bright[soft ? 1 : 0] = r.combined.at(12, 12).x;
    }
    EXPECT_NEAR(bright[1] / bright[0], 1, 1e-5);
}

TEST(SoftSun, ShinesNotThroughTheSurfaceThatItStandsHalfBehind) {
    // Shading normals lean towards it, the surface itself does not.
    constexpr double half_angle = 0.15;
    scene::Mesh mesh = SceneBuilder::quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
    const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 1, 0));
    mesh.normals.assign(mesh.positions.size(), glm::vec3(normal));
    SceneBuilder b;
    b.add_object(b.add_mesh(mesh), b.add_material(glm::vec3(0.5f)));
    b.add_camera({0, 8, 0.01f}, {0, 0, 0}, 0.5f);
    b.add_sun({-1, 0, 0}, 2);
    b.film().lights.back().angle = half_angle;
    double visible = 0;
    constexpr int n = 400;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double low = 1 - std::cos(half_angle), x = 1 - low * (i + 0.5) / n, turn = 2 * pi * (j + 0.5) / n;
            const double y = std::sqrt(1 - x * x) * std::sin(turn);
            visible += y > 0 ? (x + y) * std::sqrt(0.5) * 2 * pi * low / (n * n) : 0;
        }
    visible *= 2 / (pi * std::sin(half_angle) * std::sin(half_angle));
    FilmStage stage(b, without_bounces());
    EXPECT_NEAR(stage.reference().combined.at(12, 12).x / (0.5 / pi * visible), 1, 0.005);
    EXPECT_NEAR(stage.cut(0.02f).combined.at(12, 12).x / (0.5 / pi * visible), 1, 0.02);
}

TEST(SoftSun, OfTheRealSunsSizeTakesFewRaysBesideRecords) {
    // Its light is gathered for every point, as far as its tolerance asks, and not by all samples.
    SceneBuilder b = floor_of();
    b.add_box({-0.5f, 0, -0.5f}, {0.5f, 0.5f, 0.5f}, b.add_material(glm::vec3(0.5f)));
    b.add_sun({0.3f, -1, 0.2f}, 2);
    b.film().lights.back().angle = 0.0046f;
    Settings settings = without_bounces();
    settings.cache = CacheUse::on;
    FilmStage stage(b, settings);
    stage.cut(0.02f);
    EXPECT_GT(stage.statistics().gather_points, 400u);
    EXPECT_LT(stage.statistics().shadow_rays, 100 * stage.statistics().gather_points);
}

TEST(SoftSun, OfTheRealSunsSizeIsSampledAnewForFinerTolerances) {
    SceneBuilder b = floor_of();
    b.film().cameras.clear();
    b.add_camera({0.9f, 1.2f, 0.01f}, {0, 0, 0}, 0.9f);
    b.add_quad({-50, 20, 50}, {50, 0, 0}, {0, 0, -100}, b.add_material(glm::vec3(0)));
    b.add_sun({0, -1, 0}, 2);
    b.film().lights.back().angle = 0.017f;
    Settings settings = without_bounces();
    settings.cache = CacheUse::on;
    FilmStage stage(b, settings);
    stage.restart(true);
    const core::Radiance rough = stage.cut(0.5f);
    ASSERT_FALSE(rough.error.values().empty());
    EXPECT_GT(*std::max_element(rough.error.values().begin(), rough.error.values().end()), 0.0f);
    const std::uint64_t before = stage.statistics().shadow_rays;
    stage.cut(0.005f);
    EXPECT_GT(stage.statistics().shadow_rays, before + 1000);
}

TEST(AreaLamps, AreThoseThatShineEvenlyAndCarryMuchOfTheLight) {
    SceneBuilder b = floor_of();
    const int panel = b.add_quad({-0.5f, 1, -0.25f}, {1, 0, 0}, {0, 0, 0.5f}, b.add_emitter(glm::vec3(3)));
    const int ball = b.add_sphere({3, 1, 0}, 0.3f, b.add_emitter(glm::vec3(2)), 24);
    const int box = b.add_box({-3, 1, 0}, {-2.5f, 1.5f, 0.5f}, b.add_emitter(glm::vec3(2)));
    const int dim = b.add_quad({-0.5f, 2, -0.25f}, {0.1f, 0, 0}, {0, 0, 0.05f}, b.add_emitter(glm::vec3(3)));
    LitStage stage(b);
    const auto points = stage.direct_points(256, 1);
    const AreaLamps lamps(stage.posed_scene(), points);
    std::vector<int> whole;
    for (const auto& lamp : lamps.at(stage.posed_scene())) whole.push_back(static_cast<int>(lamp->object));
    EXPECT_EQ(whole, (std::vector<int>{panel, ball}));
    for (const LightPoint& p : lamps.without(points))
        EXPECT_TRUE(static_cast<int>(p.object) == box || static_cast<int>(p.object) == dim);
    EXPECT_FALSE(lamps.without(points).empty());
}

/// The objects and, as -1, suns that are lit by as a whole, as the film is at second 0.
std::vector<int> whole_in(const SceneBuilder& b) {
    LitStage stage(b);
    std::vector<int> whole;
    for (const auto& lamp : AreaLamps(stage.posed_scene(), stage.direct_points(256, 1)).at(stage.posed_scene()))
        whole.push_back(lamp->object == core::no_id ? -1 : static_cast<int>(lamp->object));
    return whole;
}

TEST(AreaLamps, AreNoBallsThatAreEverAnythingButRound) {
    SceneBuilder b = floor_of();
    const int ball = b.add_sphere({0, 1, 0}, 0.3f, b.add_emitter(glm::vec3(2)), 24);
    const int node = b.film().objects[static_cast<std::size_t>(ball)].node;
    SceneBuilder flattened = b;
    flattened.add_track(scene::TrackTarget::scale, node, 3, {0, 5}, {1, 1, 1, 1, 0.05f, 1});
    EXPECT_TRUE(whole_in(flattened).empty());
    SceneBuilder swollen = b;
    swollen.add_track(scene::TrackTarget::scale, node, 3, {0, 5}, {1, 1, 1, 2, 2, 2});
    EXPECT_EQ(whole_in(swollen), std::vector<int>{ball});
    // Hidden at first, when it lies nowhere.
    SceneBuilder hidden = flattened;
    hidden.film().tracks.back().values = {2, 0.3f, 2, 2, 0.3f, 2};
    hidden.add_track(scene::TrackTarget::visibility, node, 1, {0, 1}, {0, 1});
    hidden.film().tracks.back().interpolation = scene::Interpolation::step;
    double mean[2];
    for (const bool from_the_first : {false, true}) {
        FilmStage stage(hidden, without_bounces());
        if (from_the_first) stage.cut(0.02f, 0);
        double sum = 0;
        const core::Radiance frame = stage.cut(0.02f, 2);
        for (const glm::vec3& v : frame.combined.values()) sum += v.y;
        mean[from_the_first ? 1 : 0] = sum;
    }
    EXPECT_NEAR(mean[1] / mean[0], 1, 0.03);
}

TEST(AreaLamps, AreNoBallsThatShineInwards) {
    SceneBuilder b = floor_of();
    const int glow = b.add_emitter(glm::vec3(2));
    const int ball = b.add_sphere({0, 1, 0}, 30, glow, 24);
    EXPECT_EQ(whole_in(b), std::vector<int>{ball});
    b.material(glow).double_sided = true;
    EXPECT_TRUE(whole_in(b).empty());
}

TEST(AreaLamps, AreNoBallsWithHolesNorDoubledOnes) {
    SceneBuilder b = floor_of();
    const int ball = b.add_sphere({0, 1, 0}, 0.3f, b.add_emitter(glm::vec3(2)), 48);
    EXPECT_EQ(whole_in(b), std::vector<int>{ball});
    scene::Mesh& mesh =
        b.film().meshes[static_cast<std::size_t>(b.film().objects[static_cast<std::size_t>(ball)].mesh)];
    const std::vector<glm::uvec3> once = mesh.triangles;
    mesh.triangles.resize(once.size() - 300);
    EXPECT_TRUE(whole_in(b).empty());
    mesh.triangles = once;
    mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
    EXPECT_TRUE(whole_in(b).empty());
}

TEST(AreaLamps, AreAllSoftSuns) {
    SceneBuilder b = floor_of();
    for (int i = 0; i < 17; ++i) {
        b.add_sun({0.3f, -1, 0.2f}, 0.1f);
        b.film().lights.back().angle = 0.1f;
    }
    EXPECT_EQ(whole_in(b), std::vector<int>(17, -1));
}

TEST(AreaLamps, AreChosenByHowLargeThingsAreWhileTheyAreSeen) {
    // A hidden ball whose mesh is huge, and which the film never shows so.
    SceneBuilder b = floor_of();
    const int panel = b.add_quad({-0.5f, 1, -0.25f}, {1, 0, 0}, {0, 0, 0.5f}, b.add_emitter(glm::vec3(3)));
    const int ball = b.add_sphere({3, 1, 0}, 20, b.add_emitter(glm::vec3(2)), 24);
    const int node = b.film().objects[static_cast<std::size_t>(ball)].node;
    b.add_track(scene::TrackTarget::scale, node, 3, {0, 1}, {0.002f, 0.002f, 0.002f, 0.002f, 0.002f, 0.003f});
    b.add_track(scene::TrackTarget::visibility, node, 1, {0, 1}, {0, 1});
    b.film().tracks.back().interpolation = scene::Interpolation::step;
    EXPECT_EQ(whole_in(b), std::vector<int>{panel});
}

TEST(AreaLamps, ThrowShadowsOfThingsThatMoveBesideRecords) {
    SceneBuilder b = floor_of();
    b.film().cameras.clear();
    b.add_camera({0, 3, 4}, {0, 0, 0}, 0.8f);
    b.add_quad({-0.2f, 2, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, b.add_emitter(glm::vec3(30)));
    const int box = b.add_box({-0.3f, 0.3f, -0.3f}, {0.3f, 0.9f, 0.3f}, b.add_material(glm::vec3(0.5f)));
    b.move_object(box, {{-0.5f, 0, 0}, {0.5f, 0, 0}});
    double mean[2];
    for (const bool caches : {false, true}) {
        Settings settings = without_bounces();
        settings.cache = caches ? CacheUse::on : CacheUse::off;
        FilmStage stage(b, settings);
        double sum = 0;
        const core::Radiance frame = stage.cut(0.02f);
        for (const glm::vec3& v : frame.combined.values()) sum += v.y;
        mean[caches ? 1 : 0] = sum;
    }
    EXPECT_NEAR(mean[1] / mean[0], 1, 0.02);
}

TEST(AreaLamps, OfAnExtremeSceneAreFinite) {
    // A lamp that covers the sky, one inside a wall, one that touches the floor, a hundred panels.
    SceneBuilder b = floor_of();
    b.add_quad({-1e6f, 5, -1e6f}, {2e6f, 0, 0}, {0, 0, 2e6f}, b.add_emitter(glm::vec3(1e-3f)));
    b.add_quad({-1, 0, 0}, {2, 0, 0}, {0, 2, 0}, b.add_emitter(glm::vec3(1e9f)));
    for (int i = 0; i < 100; ++i)
        b.add_quad({0.01f * static_cast<float>(i), -1, 0}, {1, 0, 0}, {0, 1e-6f, 0}, b.add_emitter(glm::vec3(1e12f)));
    FilmStage stage(b, without_bounces());
    const scene::Snapshot world = stage.at(0);
    const Frame seen = stage.renderer().look(world);
    for (const auto& tolerance : {core::ToleranceMap::reference(), core::ToleranceMap::uniform(24, 24, {0, 0.02f})}) {
        const core::Radiance r = stage.renderer().light(world, seen, {tolerance}).radiance;
        for (const glm::vec3& p : r.combined.values()) EXPECT_TRUE(std::isfinite(p.x) && p.x >= 0);
    }
    EXPECT_EQ(stage.statistics().non_finite, 0u);
}

}  // namespace
}  // namespace render2mpeg::renderer
