// Light within pixels, where it is steep.
#include "renderer/cut/steep_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/color.h"
#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;

constexpr int room_size = 32;

Settings room_settings(int side, int samples) {
    Settings settings = test::small_frame(side, side);
    settings.samples = settings.edge_samples = samples;
    return settings;
}

struct Lit {
    Seen seen;
    core::Radiance once, closer;
    std::size_t points = 0;  ///< before any was split
    std::uint64_t rays = 0;  ///< that splitting took
};

Lit light_room(FilmStage& stage, const core::ToleranceMap& tolerance, int second = 0) {
    const scene::Snapshot world = stage.at(second);
    Lit lit;
    lit.seen = stage.renderer().see(world);
    lit.once = lit.closer = stage.renderer().shade(world, lit.seen, tolerance);
    for (const GatherTile& tile : lit.seen.tiles) lit.points += tile.size();
    const std::uint64_t before = stage.statistics().shadow_rays;
    stage.renderer().light_closer(world, tolerance, lit.seen, lit.closer);
    lit.rays = stage.statistics().shadow_rays - before;
    return lit;
}

constexpr glm::vec3 lamp{0.013f, 0.05f, 0.021f};

/// A floor with a lamp as near to it as a pixel is wide.
test::SceneBuilder lamp_over_floor() {
    test::SceneBuilder b;
    b.add_quad({-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, b.add_material(glm::vec3(0.5f)));
    b.add_point_light(lamp, 1.0f);
    b.add_camera({0.01f, 1.2f, 0.01f}, {0, 0, 0}, 0.9f);
    return b;
}

/// Mean luminance of a pixel of the floor.
double light_of(const scene::Camera& camera, int x, int y) {
    double sum = 0;
    constexpr int fine = 16;
    for (int i = 0; i < fine * fine; ++i) {
        const glm::vec2 place(static_cast<float>(x) + (static_cast<float>(i % fine) + 0.5f) / fine,
                              static_cast<float>(y) + (static_cast<float>(i / fine) + 0.5f) / fine);
        const scene::Ray ray = camera.ray_through(place);
        const glm::vec3 to = lamp - (ray.origin - ray.origin.y / ray.direction.y * ray.direction);
        const double d2 = glm::dot(to, to);
        sum += 0.5 / std::numbers::pi * lamp.y / (d2 * std::sqrt(d2)) / (fine * fine);
    }
    return sum;
}

TEST(SteepLight, IsWhatPixelsShowOnAverage) {
    FilmStage stage(lamp_over_floor(), room_settings(room_size, 4));
    const auto tolerance = core::ToleranceMap::uniform(room_size, room_size, {0, 0.04f});
    const Lit lit = light_room(stage, tolerance);
    double once = 0, closer = 0;
    for (int y = 0; y < room_size; ++y)
        for (int x = 0; x < room_size; ++x) {
            const double truth = light_of(stage.at(0).camera, x, y);
            once += std::pow(core::luminance(lit.once.combined.at(x, y)) / truth - 1.0, 2.0);
            closer += std::pow(core::luminance(lit.closer.combined.at(x, y)) / truth - 1.0, 2.0);
        }
    EXPECT_GT(std::sqrt(once / (room_size * room_size)), 0.005);
    EXPECT_LT(closer, 0.5 * once);
    // Few pixels are near the lamp.
    std::size_t points = 0;
    for (const GatherTile& tile : lit.seen.tiles) points += tile.size();
    EXPECT_GT(points, lit.points);
    EXPECT_LT(points, 2 * lit.points);
}

TEST(SteepLight, IsAuditedWhereItWasLit) {
    FilmStage stage(test::furnished_room(), room_settings(room_size, 16));
    const auto tolerance = core::ToleranceMap::uniform(room_size, room_size, {0, 0.02f});
    const Lit lit = light_room(stage, tolerance);
    EXPECT_GT(lit.rays, 0u);
    int over = 0;
    for (const AuditedPixel& p : stage.renderer().audit(stage.at(0), lit.seen, tolerance, lit.closer, 400))
        over += p.over() ? 1 : 0;
    EXPECT_LE(over, 8);
}

TEST(SteepLight, IsKeptWhileNothingChanges) {
    FilmStage stage(test::furnished_room(), room_settings(room_size, 4));
    const auto tolerance = core::ToleranceMap::uniform(room_size, room_size, {0, 0.02f});
    const Lit first = light_room(stage, tolerance), second = light_room(stage, tolerance);
    EXPECT_GT(first.rays, 0u);
    ASSERT_TRUE(test::same_bytes(first.once, second.once));
    EXPECT_TRUE(test::same_bytes(first.closer, second.closer));
    EXPECT_EQ(second.rays, 0u);
}

TEST(SteepLight, IsNotSplitWhereItMayErrMore) {
    FilmStage stage(test::furnished_room(), room_settings(room_size, 4));
    const Lit lit = light_room(stage, core::ToleranceMap::uniform(room_size, room_size, {100.0f, 0.02f}));
    EXPECT_EQ(lit.rays, 0u);
    EXPECT_TRUE(test::same_bytes(lit.once, lit.closer));
}

TEST(SteepLight, DoesNotDependOnThreads) {
    core::Radiance pictures[2];
    std::vector<glm::vec3> places[2];
    for (const int threads : {1, 4}) {
        const parallel::ThreadLimit limit(threads);
        FilmStage stage(test::furnished_room(), room_settings(room_size, 16));
        const Lit lit = light_room(stage, core::ToleranceMap::uniform(room_size, room_size, {0, 0.02f}));
        pictures[threads / 4] = lit.closer;
        for (const GatherTile& tile : lit.seen.tiles)
            for (const GatherPoint& p : tile) places[threads / 4].push_back(p.point.position);
        EXPECT_GT(places[threads / 4].size(), lit.points);
    }
    EXPECT_TRUE(test::same_bytes(pictures[0], pictures[1]));
    EXPECT_EQ(places[0], places[1]);
}

TEST(SteepLight, RenumbersPointsThatWereMoved) {
    // A film that keeps records moves points to their places while its camera walks; what they show is audited there.
    Settings settings = room_settings(room_size, 4);
    settings.cache = CacheUse::on;
    test::SceneBuilder b = test::furnished_room();
    b.add_track(scene::TrackTarget::translation, b.film().cameras[0].node, 3, {0, 1},
                {2.0f, 1.6f, 3.8f, 2.08f, 1.6f, 3.8f});
    FilmStage stage(b, settings);
    const auto tolerance = core::ToleranceMap::uniform(room_size, room_size, {0, 0.05f});
    light_room(stage, tolerance);
    const Lit lit = light_room(stage, tolerance, 1);
    EXPECT_GT(stage.statistics().cache.at_record, 0u);
    EXPECT_GT(lit.rays, 0u);
    const auto audited = stage.renderer().audit(stage.at(1), lit.seen, tolerance, lit.closer, 1000);
    int over = 0;
    for (const AuditedPixel& p : audited) over += p.over() ? 1 : 0;
    EXPECT_LE(over, 30);
    EXPECT_GE(audited.size(), 900u);
}

}  // namespace
}  // namespace render2mpeg::renderer
