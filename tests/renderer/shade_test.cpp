#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/color.h"
#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::furnished_room;
using test::same_bytes;
using test::SceneBuilder;

constexpr float half_turn = std::numbers::pi_v<float>;

/// Relative errors in luminance of all lit pixels, sorted.
std::vector<double> errors(const core::Radiance& truth, const core::Radiance& other) {
    std::vector<double> e;
    for (std::size_t i = 0; i < truth.combined.size(); ++i) {
        const double t = core::luminance(truth.combined.values()[i]), o = core::luminance(other.combined.values()[i]);
        if (t > 0) e.push_back(std::abs(o - t) / t);
    }
    std::sort(e.begin(), e.end());
    return e;
}

/// A floor under one lamp, seen from above.
SceneBuilder floor_and_lamp(float intensity) {
    SceneBuilder b;
    b.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, b.add_material(glm::vec3(0.5f)));
    b.add_point_light({0.3f, 2, -0.4f}, intensity, {1, 0.5f, 0.25f});
    b.add_camera({0, 8, 0.01f}, {0, 0, 0}, 0.8f);
    return b;
}

TEST(Shade, LightsTheSeamsOfWallsSlow) {
    // Looked at from the middle of a room, the picture's diagonals run along the seams of its walls: each pixel there
    // is about as bright as the brighter of its neighbours on the two walls, and none is black.
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.5f));
    b.add_quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, white);  // floor
    b.add_quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);   // ceiling
    b.add_quad({-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, white);  // left
    b.add_quad({1, -1, 1}, {0, 2, 0}, {0, 0, -2}, white);   // right
    b.add_quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white);  // back
    b.add_point_light({0.1f, 0.2f, 0.3f}, 1);
    b.add_camera({0, 0, 2}, {0, 0, 0}, 2 * std::atan(1.0f));
    constexpr int size = 24;
    FilmStage stage(b);
    const scene::Snapshot world = stage.at(0);
    const Frame seen = stage.renderer().look(world);
    const core::Radiance r = stage.renderer().light(world, seen, {core::ToleranceMap::reference()}).radiance;
    for (int i = 1; i + 1 < size; ++i)
        for (const int y : {i, size - 1 - i}) {
            const float here = r.combined.at(i, y).x, left = r.combined.at(i - 1, y).x,
                        right = r.combined.at(i + 1, y).x;
            EXPECT_GT(here, 0.5f * std::min(left, right)) << i << " " << y;
            EXPECT_LT(here, 1.5f * std::max(left, right)) << i << " " << y;
        }
}

TEST(Shade, OfOnePointLightIsTheInverseSquareLaw) {
    FilmStage stage(floor_and_lamp(7));
    const scene::Snapshot world = stage.at(0);
    const Frame seen = stage.renderer().look(world);
    for (const auto& tolerance : {core::ToleranceMap::reference(), core::ToleranceMap::uniform(24, 24, {0, 0.02f})}) {
        const core::Radiance r = stage.renderer().light(world, seen, {tolerance}).radiance;
        int compared = 0;
        for (int y = 0; y < 24; ++y) {
            for (int x = 0; x < 24; ++x) {
                const auto p = scene::carry(seen.visible.address.at(x, y), world);
                if (!p) continue;
                const glm::vec3 d = glm::vec3(0.3f, 2, -0.4f) - *p;
                const float d2 = glm::dot(d, d);
                const float expected = 0.5f / half_turn * 7 * 2 / (std::sqrt(d2) * d2);
                EXPECT_NEAR(r.combined.at(x, y).x, expected, 2e-5f * expected);
                EXPECT_NEAR(r.combined.at(x, y).z, 0.25f * expected, 2e-5f * expected);
                ++compared;
            }
        }
        EXPECT_GT(compared, 400);
    }
}

TEST(Shade, OfAUniformSkyOnAConvexBodyIsReflectanceTimesSky) {
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, b.add_material(glm::vec3(0.6f)), 32);
    b.film().sky.color = {2, 1, 0.5f};
    b.add_camera({0, 0, 4}, {0, 0, 0}, 0.3f);
    Settings settings = test::small_frame();
    settings.direct_points = 4000;
    settings.vpls = 0;
    FilmStage stage(b, settings);
    const core::Radiance r = stage.reference();
    for (const glm::vec3& p : r.combined.values()) {
        // Facets and smooth normals disagree by up to 3 degrees, where light from behind the facet counts as none.
        EXPECT_NEAR(p.x, 1.2f, 0.03f);
        EXPECT_NEAR(p.x / p.z, 4.0f, 1e-3f);
    }
}

TEST(Shade, WithoutAnyLightIsBlack) {
    // A lamp that is there but off: a film without any gets a sky.
    SceneBuilder b = floor_and_lamp(1);
    scene::Track off;
    off.target = scene::TrackTarget::light_intensity;
    off.index = 0;
    off.width = 1;
    off.times = {0};
    off.values = {0};
    b.film().tracks.push_back(off);
    FilmStage stage(b);
    for (const core::Radiance& r : {stage.reference(), stage.cut(0.02f)})
        for (const glm::vec3& p : r.combined.values()) EXPECT_EQ(p, glm::vec3(0));
    EXPECT_EQ(stage.statistics().non_finite, 0u);
    EXPECT_EQ(stage.statistics().capped_points, 0u);
}

TEST(Shade, OfAnEmptySceneIsTheSky) {
    SceneBuilder b;
    b.film().sky.color = {0.25f, 0.5f, 1};
    b.add_camera({0, 0, 4}, {0, 0, 0});
    FilmStage stage(b);
    const core::Radiance picture = stage.cut(0.02f);
    for (const glm::vec3& p : picture.combined.values()) {
        EXPECT_NEAR(p.x, 0.25f, 1e-5f);
        EXPECT_NEAR(p.y, 0.5f, 1e-5f);
        EXPECT_NEAR(p.z, 1.0f, 1e-5f);
    }
}

TEST(Shade, WithToleranceZeroEqualsTheSumOverAllLights) {
    Settings settings = test::lightcuts_frame();
    settings.max_cut = 1 << 20;
    FilmStage stage(furnished_room(), settings);
    const std::vector<double> e = errors(stage.reference(), stage.cut(0.0f));
    ASSERT_GT(e.size(), 500u);
    EXPECT_LT(e.back(), 2e-5);
    EXPECT_EQ(stage.statistics().capped_points, 0u);
}

TEST(Shade, GrowsNearerToTheReferenceAsTheToleranceShrinksSlow) {
    FilmStage stage(furnished_room(), test::lightcuts_frame(48, 48));
    const core::Radiance truth = stage.reference();
    double last_median = 1;
    std::uint64_t last_clusters = 0,
                  counted = stage.statistics().direct_clusters + stage.statistics().indirect_clusters;
    for (const float tolerance : {0.26f, 0.08f, 0.02f, 0.005f}) {
        const std::vector<double> e = errors(truth, stage.cut(tolerance));
        const std::uint64_t all = stage.statistics().direct_clusters + stage.statistics().indirect_clusters;
        EXPECT_LT(e[e.size() / 2], last_median);
        EXPECT_GT(all - counted, last_clusters);
        last_median = e[e.size() / 2];
        last_clusters = all - counted;
        counted = all;
    }
    EXPECT_LT(last_median, 0.01);
}

TEST(Shade, IsBrighterByExactlyWhatTheLightIsSlow) {
    const Settings settings = test::small_frame(8, 8);
    FilmStage one(furnished_room(5.0f), settings), four(furnished_room(20.0f), settings);
    for (const float tolerance : {0.02f, -1.0f}) {
        const core::Radiance a = tolerance < 0 ? one.reference() : one.cut(tolerance);
        const core::Radiance b = tolerance < 0 ? four.reference() : four.cut(tolerance);
        for (std::size_t i = 0; i < a.combined.size(); ++i)
            ASSERT_EQ(a.combined.values()[i] * 4.0f, b.combined.values()[i]) << i;
    }
}

TEST(Shade, IsTheSameForAnyNumberOfThreadsSlow) {
    Settings settings = test::lightcuts_frame(40, 36);
    for (const Indirect indirect : {Indirect::lightcuts, Indirect::rays}) {
        settings.indirect = indirect;
        core::Radiance one, two;
        {
            const parallel::ThreadLimit limit(1);
            FilmStage stage(furnished_room(), settings);
            one = stage.cut(0.02f);
        }
        {
            const parallel::ThreadLimit limit(2);
            FilmStage stage(furnished_room(), settings);
            two = stage.cut(0.02f);
        }
        EXPECT_TRUE(same_bytes(one, two));
    }
}

TEST(Shade, OfAStillFilmIsStill) {
    FilmStage stage(furnished_room());
    const core::Radiance first = stage.cut(0.02f, 0);
    const std::uint64_t photons = stage.statistics().photon_rays;
    EXPECT_TRUE(same_bytes(first, stage.cut(0.02f, 1)));
    EXPECT_TRUE(same_bytes(first, stage.cut(0.02f, 7)));
    EXPECT_EQ(stage.statistics().photon_rays, photons);  // nothing that light touches has moved
}

/// The lamp of the room swings.
SceneBuilder room_with_moving_lamp() {
    SceneBuilder b = furnished_room();
    const int lamp = b.add_sphere({0, 0, 0}, 0.1f, b.add_emitter({80, 40, 20}), 8);
    b.move_object(lamp, {{1, 2, 1}, {3, 2, 1}, {3, 1, 3}});
    return b;
}

TEST(Shade, OfAMovedLightIsThatOfAFreshChunkAtTheSameStartSlow) {
    FilmStage walked(room_with_moving_lamp(), test::lightcuts_frame()),
        jumped(room_with_moving_lamp(), test::lightcuts_frame());
    walked.renderer().start_chunk(walked.at(0));
    jumped.renderer().start_chunk(jumped.at(0));
    walked.cut(0.02f, 0);
    walked.cut(0.02f, 1);
    const core::Radiance end = walked.cut(0.02f, 2);
    EXPECT_TRUE(same_bytes(end, jumped.cut(0.02f, 2)));
    EXPECT_FALSE(same_bytes(end, jumped.cut(0.02f, 0)));
    // And back again: nothing is left of what was in between.
    EXPECT_TRUE(same_bytes(walked.cut(0.02f, 0), jumped.cut(0.02f, 0)));
}

TEST(Shade, SeesAheadWithoutChangingWhatIsShaded) {
    FilmStage stage(room_with_moving_lamp());
    stage.renderer().start_chunk(stage.at(0));
    const core::Radiance plain = stage.cut(0.02f, 1);
    const scene::Snapshot now = stage.at(1), later = stage.at(2);
    const Frame seen = stage.renderer().look(now);
    stage.renderer().look(later);
    EXPECT_TRUE(same_bytes(
        plain, stage.renderer().light(now, seen, {core::ToleranceMap::uniform(24, 24, {0, 0.02f})}).radiance));
}

TEST(Shade, CountsPointsWhoseToleranceTheLargestCutMissed) {
    Settings settings = test::lightcuts_frame();
    settings.max_cut = 6;
    FilmStage stage(furnished_room(), settings);
    stage.cut(0.0f);
    EXPECT_GT(stage.statistics().capped_points, stage.statistics().gather_points * 8 / 10);
    EXPECT_LE(stage.statistics().direct_clusters + stage.statistics().indirect_clusters,
              (6 + 1) * stage.statistics().gather_points)
        << "the cut, and the panel that is lit by as a whole";
}

TEST(Shade, StopsAtAnAbsoluteToleranceInTheDark) {
    // Far below the absolute tolerance, a few clusters must do; without it the same points need many.
    FilmStage stage(furnished_room(1e-3f), test::lightcuts_frame());
    stage.shade(0, core::ToleranceMap::uniform(24, 24, {1.0f, 0.02f}));
    const std::uint64_t few = stage.statistics().direct_clusters + stage.statistics().indirect_clusters;
    stage.shade(0, core::ToleranceMap::uniform(24, 24, {0.0f, 0.02f}));
    const std::uint64_t many = stage.statistics().direct_clusters + stage.statistics().indirect_clusters - few;
    EXPECT_LE(few, (8 + 1) * stage.statistics().gather_points / 2) << "and the panel";
    EXPECT_GT(many, 4 * few);
}

TEST(Shade, ReplacesAndCountsWhatIsNotFinite) {
    // A lamp as strong as single precision has, a hair above what one pixel shows.
    FilmStage dim(floor_and_lamp(1));
    const scene::Snapshot world = dim.at(0);
    const auto place = scene::carry(dim.renderer().look(world).visible.address.at(7, 9), world);
    ASSERT_TRUE(place.has_value());
    SceneBuilder b = floor_and_lamp(1e30f);
    b.film().nodes[static_cast<std::size_t>(b.film().lights[0].node)].translation =
        glm::dvec3(*place) + glm::dvec3(0, 1e-5, 0);
    FilmStage stage(b);
    const core::Radiance picture = stage.reference();
    for (const glm::vec3& p : picture.combined.values()) ASSERT_TRUE(std::isfinite(p.x) && p.x >= 0);
    EXPECT_EQ(picture.combined.at(7, 9), glm::vec3(0));
    EXPECT_EQ(stage.statistics().non_finite, 1u);
    EXPECT_EQ(stage.statistics().first_non_finite, "frame 0, pixel (7, 9)");
}

TEST(Shade, LayersAddUpToThePictureSlow) {
    SceneBuilder b = furnished_room();
    const int shiny = b.add_material({0.5f, 0.4f, 0.3f});
    b.material(shiny).roughness = 0.4f;
    b.material(shiny).ior = 1.5f;
    b.add_sphere({2.0f, 0.4f, 2.6f}, 0.4f, shiny, 12);
    const int mirror = b.add_material({0.9f, 0.9f, 0.9f});
    b.material(mirror).metallic = 1;
    b.material(mirror).roughness = 0;
    b.add_quad({0.5f, 0.2f, 0.1f}, {1, 0, 0}, {0, 1, 0}, mirror);
    Settings settings = test::small_frame(40, 40);
    settings.samples = 4;
    FilmStage stage(b, settings);
    const core::Radiance plain = stage.cut(0.02f);
    EXPECT_TRUE(plain.albedo.empty());
    stage.restart(true);
    const core::Radiance r = stage.cut(0.02f);
    EXPECT_TRUE(same_bytes(plain, r));  // asking for layers changes no pixel
    double glossy = 0, specular = 0;
    for (std::size_t i = 0; i < r.combined.size(); ++i) {
        const glm::vec3 sum =
            r.emission.values()[i] +
            r.albedo.values()[i] * (r.direct_irradiance.values()[i] + r.indirect_irradiance.values()[i]) +
            r.glossy.values()[i] + r.specular.values()[i];
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(sum[k], r.combined.values()[i][k], 1e-4f * (1 + sum[k])) << i;
        glossy += r.glossy.values()[i].x;
        specular += r.specular.values()[i].x;
    }
    EXPECT_GT(glossy, 0);
    EXPECT_GT(specular, 0);
}

TEST(Shade, ClustersManyLampsAndGathersFewExactly) {
    for (const int lamps : {16, 200}) {
        SceneBuilder b;
        b.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, b.add_material(glm::vec3(0.5f)));
        for (int i = 0; i < lamps; ++i)
            b.add_point_light(
                {-4.5f + 0.6f * static_cast<float>(i % 16), 1.0f, -4.5f + 0.7f * static_cast<float>(i / 16)}, 1.0f);
        b.add_camera({0, 8, 0.01f}, {0, 0, 0}, 0.8f);
        Settings settings = test::lightcuts_frame();
        settings.vpls = 0;
        FilmStage stage(b, settings);
        const core::Radiance truth = stage.reference();
        const std::uint64_t all = stage.statistics().direct_clusters;
        const std::vector<double> e = errors(truth, stage.cut(0.05f));
        const std::uint64_t used = stage.statistics().direct_clusters - all;
        if (lamps == 16) {
            EXPECT_LT(e.back(), 1e-6);
            EXPECT_EQ(used, all);
        } else {
            EXPECT_LT(e[e.size() * 95 / 100], 0.1);
            EXPECT_LT(used, all / 2);
        }
    }
}

TEST(Shade, LetsLightThroughGlassInItsColour) {
    SceneBuilder b = floor_and_lamp(7);
    const int glass = b.add_material({1.0f, 0.5f, 0.25f});
    b.material(glass).transmission = 1;
    b.material(glass).roughness = 0;
    b.material(glass).double_sided = true;
    FilmStage open(b);
    const core::Radiance without = open.reference();
    b.add_quad({-5, 1, 5}, {10, 0, 0}, {0, 0, -10},
               glass);  // between lamp and floor; the camera looks through it as well
    b.film().cameras.clear();
    b.add_camera({0, 0.9f, 0.01f}, {0, 0, 0}, 1.4f);
    FilmStage covered(b);
    const core::Radiance with = covered.cut(0.02f);
    const glm::vec3 a = with.combined.at(12, 12), o = without.combined.at(12, 12);
    EXPECT_GT(a.x, 0.0f);
    const float ratio[] = {a.x / o.x, a.y / o.y, a.z / o.z};
    EXPECT_NEAR(ratio[1] / ratio[0], 0.5f, 0.05f);
    EXPECT_NEAR(ratio[2] / ratio[0], 0.25f, 0.03f);
}

}  // namespace
}  // namespace render2mpeg::renderer
