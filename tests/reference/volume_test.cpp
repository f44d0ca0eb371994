#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/air.h"
#include "renderer/base/blackbody.h"
#include "renderer/surface/posed_scene.h"
#include "tests/renderer/film_stage.h"

/// Volumes against closed forms and quadrature.
namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr double pi = std::numbers::pi;

/// `side` voxels each way of density by place in [0, 1]^3, in the cube [low, low + extent]^3 of object space.
std::shared_ptr<const scene::VolumeGrids> grids_of(int side, glm::dvec3 low, double extent,
                                                   const std::function<float(glm::vec3)>& density) {
    scene::VolumeGrids grids;
    const int bricks = (side + 7) / 8;
    grids.density = core::SparseGrid<float>({0, 0, 0}, glm::ivec3(bricks));
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const glm::ivec3 v(x, y, z);
                grids.density.add(v >> 3)[core::SparseGrid<float>::place_in_brick(v)] =
                    density((glm::vec3(v) + 0.5f) / static_cast<float>(side));
            }
    const double voxel = extent / side;
    grids.object_from_index = glm::dmat4(voxel);
    grids.object_from_index[3] = glm::dvec4(low + 0.5 * voxel, 1);
    return std::make_shared<const scene::VolumeGrids>(std::move(grids));
}

/// An even cube of side 2 about the origin.
scene::Volume even_cube(int side = 32) {
    scene::Volume volume;
    volume.grids = grids_of(side, glm::dvec3(-1), 2, [](glm::vec3) { return 1.0f; });
    return volume;
}

Air air_with(std::vector<scene::Volume> volumes, const glm::dmat4& to_world = glm::dmat4(1)) {
    std::vector<VolumeMedium> media;
    for (const scene::Volume& v : volumes)
        media.emplace_back(v, std::make_shared<const VolumeField>(v, v.grids), to_world);
    return Air({}, std::move(media));
}

TEST(Volume, EvenCubeDimsByBeerAndLambert) {
    for (const float density : {0.1f, 1.0f, 3.0f}) {
        scene::Volume volume = even_cube();
        volume.density = density;
        const Air air = air_with({volume});
        // Along an axis, across from face to face, and from within.
        EXPECT_NEAR(air.transmittance({-5, 0.1f, 0.2f}, {1, 0, 0}, 10).x / std::exp(-2 * density), 1, 0.01);
        const glm::vec3 slanted = glm::normalize(glm::vec3(1, 0.3f, 0.2f));
        EXPECT_NEAR(air.transmittance(-5.0f * slanted, slanted, 10).x / std::exp(-density * 2 / slanted.x), 1, 0.01);
        EXPECT_NEAR(air.transmittance({0, 0, 0}, {0, 1, 0}, 0.5f).x / std::exp(-density * 0.5f), 1, 0.01);
        EXPECT_EQ(air.transmittance({-5, 3, 0}, {1, 0, 0}, 10), glm::vec3(1));
    }
}

TEST(Volume, ScaledAndTurnedCubeKeepsItsOpticalDepth) {
    const glm::dmat4 twice = glm::dmat4(glm::dmat3(2.0));
    glm::dmat4 turned(1);
    turned[0] = {0.6, 0.8, 0, 0};
    turned[1] = {-0.8, 0.6, 0, 0};
    const glm::vec3 along(turned[0]);
    EXPECT_NEAR(air_with({even_cube()}, twice).transmittance({-9, 0, 0}, {1, 0, 0}, 99).x, std::exp(-2.0), 0.002);
    EXPECT_NEAR(air_with({even_cube()}, turned).transmittance(-9.0f * along, along, 99).x, std::exp(-2.0), 0.002);
}

/// A film of one volume, seen from +z, with a surface far away.
SceneBuilder film_of(const scene::Volume& volume) {
    SceneBuilder b;
    b.add_quad({-50, -50, -60}, {1, 0, 0}, {0, 1, 0}, b.add_material({0, 0, 0}));
    b.film().volumes.push_back(volume);
    b.add_camera({0, 0, 8}, {0, 0, 0}, 0.02f);
    return b;
}

Settings one_look(int size = 4) {
    Settings settings = test::small_frame(size, size);
    settings.caustic_photons = 0;
    return settings;
}

glm::dvec3 mean_of(const core::Radiance& r) {
    glm::dvec3 sum(0);
    for (const glm::vec3& p : r.combined.values()) sum += glm::dvec3(p);
    return sum / static_cast<double>(r.combined.size());
}

class ScatteredOnce : public testing::TestWithParam<float> {};

TEST_P(ScatteredOnce, IsThatOfQuadratureSlow) {
    scene::Volume volume = even_cube();
    volume.density = 1.5f;
    volume.color = glm::vec3(1e-5f);
    volume.anisotropy = GetParam();
    SceneBuilder b = film_of(volume);
    b.add_sun({-1, 0, 0}, 1000);
    FilmStage stage(b, one_look());
    // The eye looks along -z, the light comes from +x: by the middle it has gone 1 through the cube, whose faces fade
    // over a voxel.
    const double g = GetParam(), phase = (1 - g * g) / (4 * pi * std::pow(1 + g * g, 1.5));
    constexpr double voxel = 2.0 / 32, step = 1e-4;
    double sum = 0, depth = 0;
    for (double z = 1 + voxel; z > -1 - voxel; z -= step) {
        const double density = 1.5 * std::clamp((1 + 0.5 * voxel - std::abs(z)) / voxel, 0.0, 1.0);
        depth += 0.5 * step * density;
        sum += step * density * std::exp(-density - depth);
        depth += 0.5 * step * density;
    }
    const double expected = 1000 * 1e-5 * phase * sum;
    EXPECT_NEAR(mean_of(stage.reference()).x / expected, 1, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Phases, ScatteredOnce, testing::Values(0.0f, 0.6f, -0.4f));

TEST(Volume, LampWithinIsThatOfQuadrature) {
    scene::Volume volume = even_cube();
    volume.color = glm::vec3(1e-5f);
    SceneBuilder b = film_of(volume);
    b.add_point_light({0.5f, 0, 0}, 1000);
    FilmStage stage(b, one_look());
    double expected = 0;
    constexpr int steps = 10000;
    for (int i = 0; i < steps; ++i) {
        const double z = 1 - 2 * (i + 0.5) / steps, d2 = 0.25 + z * z;
        expected += 2.0 / steps * std::exp(-(1 - z) - std::sqrt(d2)) / d2;
    }
    expected *= 1000 * 1e-5 / (4 * pi);
    EXPECT_NEAR(mean_of(stage.reference()).x / expected, 1, 0.01);
}

class WhiteFurnace : public testing::TestWithParam<std::tuple<float, float>> {};

TEST_P(WhiteFurnace, KeepsItsEnergySlow) {
    const auto [density, anisotropy] = GetParam();
    scene::Volume volume = even_cube(24);
    volume.density = density;
    volume.color = glm::vec3(1);
    volume.anisotropy = anisotropy;
    SceneBuilder b = film_of(volume);
    b.film().sky.color = {1, 1, 1};
    b.film().objects.clear();
    FilmStage stage(b, one_look());
    EXPECT_NEAR(mean_of(stage.reference()).x, 1, 0.01) << "no surface is needed";
}

INSTANTIATE_TEST_SUITE_P(Densities, WhiteFurnace,
                         testing::Values(std::tuple(0.5f, 0.0f), std::tuple(4.0f, 0.0f), std::tuple(30.0f, 0.0f),
                                         std::tuple(4.0f, 0.7f)));

/// A cube beside another: a volume moved by its own width.
scene::Volume beside(scene::Volume volume, double width) {
    scene::VolumeGrids grids = *volume.grids;
    grids.object_from_index[3].x += width;
    volume.grids = std::make_shared<const scene::VolumeGrids>(std::move(grids));
    return volume;
}

TEST(Volume, TwoInAFurnaceKeepTheirEnergySlow) {
    for (const double apart : {0.0, 1.0, 2.5}) {
        scene::Volume volume = even_cube(24);
        volume.density = 4;
        volume.color = glm::vec3(1);
        SceneBuilder b = film_of(volume);
        volume.density = 12;
        b.film().volumes.push_back(beside(volume, apart));
        b.film().sky.color = {1, 1, 1};
        b.film().objects.clear();
        FilmStage stage(b, one_look());
        EXPECT_NEAR(mean_of(stage.reference()).x, 1, 0.01) << apart;
    }
}

TEST(Volume, FireLightsSmokeOfAnother) {
    // Thin smoke, which the eye sees through its middle, beside a fire.
    scene::Volume smoke = even_cube(), fire = even_cube(16);
    smoke.density = 0.01f;
    smoke.color = glm::vec3(1);
    fire.density = 0;
    fire.emission_strength = 2;
    SceneBuilder b = film_of(smoke);
    b.film().volumes.push_back(beside(fire, 2));
    FilmStage stage(b, one_look());
    // Mean over directions of the fire's light is that of its parts over their distances' squares.
    double expected = 0;
    constexpr int n = 40;
    for (int s = 0; s < n; ++s)
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                for (int k = 0; k < n; ++k) {
                    const glm::dvec3 p = 2.0 * (glm::dvec3(i, j, k) + 0.5) / double(n) - 1.0 + glm::dvec3(2, 0, 0);
                    const double z = 2.0 * (s + 0.5) / n - 1.0;
                    const glm::dvec3 way = p - glm::dvec3(0, 0, z);
                    expected += 0.01 * 2.0 / n * 8.0 / (n * n * n) * 2 / (4 * pi * glm::dot(way, way));
                }
    EXPECT_NEAR(mean_of(stage.reference()).x / expected, 1, 0.03);
}

TEST(Volume, ThrowsItsShadowOnAFloor) {
    scene::Volume volume = even_cube();
    volume.density = 0.8f;
    volume.color = glm::vec3(0);
    SceneBuilder b;
    b.add_quad({-20, -2, 20}, {40, 0, 0}, {0, 0, -40}, b.add_material({0.5f, 0.5f, 0.5f}));
    b.film().volumes.push_back(volume);
    b.add_sun({0, -1, 0}, 3);
    b.add_camera({0, -1.5f, 6}, {0, -2, 0}, 0.02f);
    FilmStage stage(b, one_look());
    EXPECT_NEAR(mean_of(stage.reference()).x / (3 * 0.5 / pi * std::exp(-1.6)), 1, 0.01);
}

TEST(Volume, FireLightsAWall) {
    scene::Volume volume = even_cube(16);
    volume.density = 0;
    volume.emission_strength = 2;
    volume.emission_color = {1, 0.5f, 0.2f};
    SceneBuilder b;
    b.add_quad({-3, -3, -3}, {6, 0, 0}, {0, 6, 0}, b.add_material({0.8f, 0.8f, 0.8f}));
    b.film().volumes.push_back(volume);
    // Past the fire, at the wall's middle.
    b.add_camera({6, 0, 4}, {0, 0, -3}, 0.01f);
    FilmStage stage(b, one_look());
    double irradiance = 0;
    constexpr int n = 60;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) {
                const glm::dvec3 p = 2.0 * (glm::dvec3(i, j, k) + 0.5) / double(n) - 1.0 - glm::dvec3(0, 0, -3);
                const double d2 = glm::dot(p, p);
                irradiance += 8.0 / (n * n * n) * 2 * p.z / (d2 * std::sqrt(d2));
            }
    const glm::dvec3 seen = mean_of(stage.reference());
    EXPECT_NEAR(seen.x / (0.8 / pi * irradiance), 1, 0.01);
    EXPECT_NEAR(seen.y / seen.x, 0.5, 1e-3);
}

TEST(Volume, FireIsAsBrightAsItsDepth) {
    scene::Volume volume = even_cube();
    volume.density = 1.2f;
    volume.color = glm::vec3(0);
    volume.emission_strength = 5;
    FilmStage stage(film_of(volume), one_look());
    EXPECT_NEAR(mean_of(stage.reference()).x / (5 / 1.2 * (1 - std::exp(-2.4))), 1, 0.01);
}

TEST(Volume, OverlappingOnesDimAndShineTogether) {
    scene::Volume volume = even_cube();
    volume.density = 0.7f;
    volume.color = glm::vec3(0);
    EXPECT_NEAR(air_with({volume, volume}).transmittance({-5, 0, 0}, {1, 0, 0}, 10).x, std::exp(-2.8), 1e-3);
    volume.emission_strength = 3;
    SceneBuilder b = film_of(volume);
    b.film().volumes.push_back(volume);
    FilmStage stage(b, one_look());
    EXPECT_NEAR(mean_of(stage.reference()).x / (3 / 0.7 * (1 - std::exp(-2.8))), 1, 0.01);
}

TEST(Volume, AbsorbsColoursAsCyclesDoes) {
    scene::Volume volume = even_cube();
    volume.color = {0.5f, 0.25f, 0};
    volume.absorption_color = {1, 0.25f, 0.04f};
    const glm::vec3 left = air_with({volume}).transmittance({-5, 0, 0}, {1, 0, 0}, 10);
    // color + (1 - color) (1 - sqrt(absorption_color)), over a way of 2
    EXPECT_NEAR(left.x / std::exp(-2 * 0.5), 1, 0.01);
    EXPECT_NEAR(left.y / std::exp(-2 * (0.25 + 0.75 * 0.5)), 1, 0.01);
    EXPECT_NEAR(left.z / std::exp(-2 * 0.8), 1, 0.01);
}

TEST(Volume, ShadowGoesWithIt) {
    scene::Volume volume = even_cube(8);
    volume.color = glm::vec3(0);
    SceneBuilder b;
    b.add_quad({-20, -2, 20}, {40, 0, 0}, {0, 0, -40}, b.add_material({0.5f, 0.5f, 0.5f}));
    volume.node = static_cast<int>(b.film().nodes.size());
    b.film().nodes.emplace_back();
    b.add_track(scene::TrackTarget::translation, volume.node, 3, {0, 1}, {0, 0, 0, 9, 0, 0});
    b.film().volumes.push_back(volume);
    b.add_sun({0, -1, 0}, 3);
    b.add_camera({0, -1.5f, 6}, {0, -2, 0}, 0.02f);
    FilmStage stage(b, one_look());
    EXPECT_NEAR(mean_of(stage.reference(0)).x / (3 * 0.5 / pi * std::exp(-2)), 1, 0.02);
    EXPECT_NEAR(mean_of(stage.reference(1)).x / (3 * 0.5 / pi), 1, 0.01);
}

TEST(Volume, BlackBodiesAreWhiteAtDaylightAndRedWhenCold) {
    const glm::vec3 day = blackbody_color(6500), cold = blackbody_color(1000);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(day[c], 1, 0.05);
    EXPECT_GT(cold.x, 4);
    EXPECT_LT(cold.y, 0.1f);
    // Twice as hot is sixteen times as bright.
    EXPECT_NEAR(core::luminance(blackbody_radiance(4000, 1)) / core::luminance(blackbody_radiance(2000, 1)), 16, 0.1);
}

TEST(Volume, OddOnesAreLitWithoutNaNSlow) {
    std::vector<scene::Volume> odd(8, even_cube(4));
    odd[0].density = 0;
    odd[1].density = 1e9f;
    odd[2].grids = grids_of(1, glm::dvec3(0), 0.1, [](glm::vec3) { return 5.0f; });
    odd[3].color = glm::vec3(1);
    odd[3].anisotropy = 0.95f;
    odd[4].density = 1e9f;
    odd[4].color = {1, 0.5f, 0};
    odd[4].absorption_color = {0.2f, 1, 0.5f};
    odd[5].grids = std::make_shared<const scene::VolumeGrids>();
    odd[6].grids = grids_of(4, glm::dvec3(-1), 2, [](glm::vec3) { return 1e37f; });
    odd[6].density = 1000;
    scene::VolumeGrids hot = *odd[7].grids;
    hot.temperature = grids_of(4, glm::dvec3(-1), 2, [](glm::vec3) { return 1e30f; })->density;
    odd[7].grids = std::make_shared<const scene::VolumeGrids>(std::move(hot));
    odd[7].blackbody_intensity = 1;
    // Seen from outside, then from within: their light, which is dear, is that of both frames.
    for (const scene::Volume& volume : odd) {
        SceneBuilder b;
        b.add_box({-3, -3, -3}, {3, 3, 9}, b.add_material({0.5f, 0.5f, 0.5f}), true);
        b.film().volumes.push_back(volume);
        b.film().volumes.push_back(even_cube(4));
        b.add_point_light({0.3f, 0.4f, 0.2f}, 10);
        b.add_sun({0, 0, -1}, 1);
        const int camera = b.add_camera({0, 0, 7}, {0, 0, 0}, 0.6f);
        b.add_track(scene::TrackTarget::translation, b.film().cameras[static_cast<std::size_t>(camera)].node, 3, {0, 1},
                    {0, 0, 7, 0, 0, 0.5f});
        FilmStage stage(b, one_look(4));
        for (const int second : {0, 1}) {
            const core::Radiance r = stage.cut(1, second);
            for (const glm::vec3& p : r.combined.values()) {
                EXPECT_TRUE(core::is_finite(p));
                EXPECT_GE(std::min({p.x, p.y, p.z}), 0.0f);
            }
        }
    }
}

TEST(Volume, IsLeftByRaysFromFarAway) {
    const scene::Volume volume = even_cube(32);
    const Air air = air_with({volume}, glm::scale(glm::dmat4(1), glm::dvec3(0.005)));
    for (const float far : {10.0f, 6e4f, 1e7f}) {
        BrickWalk walk(air.volumes()[0], {0.0011f, 0.0007f, far}, {0, 0, -1});
        int pieces = 0;
        while (!walk.misses() && std::isfinite(walk.end()) && pieces < 100) walk.advance(), ++pieces;
        EXPECT_LT(pieces, 10) << far;
    }
}

TEST(Volume, AbsentOnesChangeNothingSlow) {
    SceneBuilder with = test::furnished_room(), without = test::furnished_room();
    scene::Volume gone = even_cube(8);
    gone.node = static_cast<int>(with.film().nodes.size());
    with.film().nodes.emplace_back().scale = glm::dvec3(0);
    with.film().volumes.push_back(gone);
    FilmStage a(with, one_look(6)), b(without, one_look(6));
    EXPECT_EQ(test::share_over(a.reference(), b.reference(), 1e-3f), 0);
}

TEST(Volume, StillOnesStayWhatTheyAreSlow) {
    scene::Volume volume = even_cube(16);
    volume.color = glm::vec3(0.8f);
    SceneBuilder b = test::furnished_room();
    volume.grids = grids_of(16, glm::dvec3(1, 0.5, 1), 2, [](glm::vec3 p) { return 1 - glm::length(p - 0.5f); });
    b.film().volumes.push_back(volume);
    FilmStage stage(b, one_look(16));
    const core::Radiance first = stage.cut(0.05f, 0);
    EXPECT_TRUE(test::same_bytes(first, stage.cut(0.05f, 1)));
}

}  // namespace
}  // namespace render2mpeg::renderer
