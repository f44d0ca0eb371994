#include "renderer/cache/light_split.h"

#include <gtest/gtest.h>

#include "parallel/loops.h"
#include "renderer/cut/gatherer.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::share_over;
constexpr int parts_size = 48;

Settings parts_settings(bool cache) {
    Settings s = test::small_frame(parts_size, parts_size);
    s.cache = cache ? CacheUse::on : CacheUse::off;
    s.vpls = 800;
    return s;
}

constexpr glm::vec3 low{0.3f, 0.0f, 2.2f}, high{0.7f, 0.4f, 2.6f};

/// The furnished room with a lamp, and a small box that goes through these places, one a second.
test::SceneBuilder parts_room(const std::vector<glm::vec3>& places, bool walks = false, glm::vec3 reaches_to = high) {
    test::SceneBuilder b = test::furnished_room();
    b.add_point_light({0.6f, 2.4f, 3.0f}, 1.5f);
    if (walks)
        b.add_track(scene::TrackTarget::translation, b.film().cameras[0].node, 3, {0, 10},
                    {2.0f, 1.6f, 3.8f, 2.4f, 1.6f, 3.8f});
    b.move_object(b.add_box(low, reaches_to, b.add_material({0.5f, 0.5f, 0.5f})), places);
    return b;
}

constexpr glm::vec3 here{0, 0, 0}, beside{0.6f, 0, 0.1f}, below{0, -9, 0};

TEST(LightSplit, ComeToWhatAllOfItComesTo) {
    // A wall beside a box that moves, lit by lamps above and by indirect light, some of which has changed meanwhile.
    test::SceneBuilder b = parts_room({here, beside});
    test::LitStage stage(b, 1);
    test::LightingSettings lit;
    lit.paths = 4000;
    LightTrees now = stage.light(lit);
    std::vector<LightPoint> anchors;
    for (const TreeLight& l : now.trees[LightTrees::static_tree].lights) {
        LightPoint p;
        p.position = l.position;
        p.normal = l.normal();
        p.intensity = l.intensity;
        p.disc2 = l.disc2;
        p.id = static_cast<std::uint32_t>(anchors.size());
        anchors.push_back(p);
    }
    ASSERT_GT(anchors.size(), 500u);
    const std::vector<LightPoint> direct = stage.direct_points(256, 1);
    PersistentLightTrees lasting({direct, anchors, {}}, 1);
    LightSplit parts;
    ASSERT_TRUE(parts.update(lasting.at({direct, anchors, {}}), anchors, lasting));
    // By less than it takes to take them anew, one up and the next down.
    for (std::size_t i = 0; i < anchors.size(); ++i) anchors[i].intensity *= i % 2 == 0 ? 1.01f : 0.99f;
    for (std::size_t i = 0; i < 4; ++i) anchors[i].intensity *= 1.5f;
    now = lasting.at({direct, anchors, {}});
    ASSERT_FALSE(parts.update(now, anchors, lasting));

    const RayTracer& tracer = stage.posed_scene().tracer();
    double hidden = 0, changed = 0;
    for (int k = 0; k < 12; ++k) {
        const GatherPoint p = stage.point_at(0, static_cast<std::uint32_t>(k % 12), {0.3f, 0.3f}, {0, 0, 1});
        const GatherPoint* one[] = {&p};
        GatherLanes lanes;
        fill(lanes, one);
        lanes.set = 0;
        const auto light = [&](const LightTrees& light_trees) {
            GatheredLight out;
            GroupTolerance finest;
            for (int i = 0; i < lane_count; ++i) finest.set(i, {{1e-9f, 0, 0}, 0});
            CutLimits all{1, 1 << 20, 1.0f, false};
            Gatherer(light_trees, tracer).gather(lanes, finest, all, out);
            return glm::dvec3(out.direct.at(0)) + glm::dvec3(out.indirect.at(0));
        };
        const glm::dvec3 whole = light(now);
        const glm::dvec3 less = light(parts.occluded);
        const glm::dvec3 more = light(parts.gained), lost = light(parts.lost);
        const glm::dvec3 sum = light(parts.static_light) + more - lost - less;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], whole[c], 1e-4 * whole[c] + 1e-6) << k;
        hidden += less.x / std::max(whole.x, 1e-9);
        changed += (more.x + lost.x) / std::max(whole.x, 1e-9);
    }
    EXPECT_GT(hidden, 0.001) << "the box hides something";
    EXPECT_GT(changed, 0.005) << "anchors have changed";
}

TEST(LightSplit, SuitFilmsWhereAFewThingsMoveAndLightsDoNot) {
    const auto suit = [](const test::SceneBuilder& b, std::size_t still, std::size_t moving) {
        const scene::Animation film = b.build();
        const Plan plan = make_plan(scene::traits_of(film), {});
        const PosedScene posed_scene(film, core::detect_isa(), plan);
        return LightSplit::suit(posed_scene, plan, still, moving);
    };
    EXPECT_TRUE(suit(parts_room({here, beside}), 1000, 5));
    EXPECT_FALSE(suit(parts_room({here, beside}), 1000, 200)) << "what moves is much of what light falls on";
    test::SceneBuilder flickers = parts_room({here, beside});
    flickers.add_track(scene::TrackTarget::light_intensity, 0, 1, {0, 1}, {1, 2});
    EXPECT_FALSE(suit(flickers, 1000, 5));
    test::SceneBuilder stays = test::furnished_room();
    EXPECT_FALSE(suit(stays, 1000, 0));
    test::SceneBuilder crowd = parts_room({here, beside});
    for (int k = 0; k < 8; ++k) crowd.move_object(crowd.add_box(low, high, 0), {here, beside});
    EXPECT_FALSE(suit(crowd, 1000, 5));
}

TEST(LightSplit, KeepAllRecordsWhereABoxMovesSlow) {
    FilmStage stage(parts_room({here, beside}), parts_settings(true)),
        plain(parts_room({here, beside}), parts_settings(false));
    stage.cut(0.05f, 0);
    const std::uint64_t first = stage.statistics().shadow_rays, created = stage.statistics().cache.created;
    const core::Radiance frame = stage.cut(0.05f, 1), truth = plain.reference(1);
    EXPECT_LE(share_over(frame, truth, 0.05f), 0.02);
    EXPECT_LT(stage.statistics().shadow_rays - first, first * 6 / 10);
    EXPECT_LT(stage.statistics().cache.created - created, created / 4);
}

TEST(LightSplit, DecideWhetherLightIsKeptWhereOnlyStaticLightMayBeSlow) {
    Settings kept = parts_settings(true), plain = parts_settings(false);
    kept.cache = CacheUse::static_light;
    FilmStage parted(parts_room({here, beside}), kept);
    for (int second = 0; second < 2; ++second) parted.cut(0.05f, second);
    EXPECT_GT(parted.statistics().cache.created, 0u);
    EXPECT_GT(parted.statistics().cache.served, 0u);

    // A box that fills the room holds more light points than light is parted for.
    const test::SceneBuilder filled = parts_room({here, beside}, false, {2.0f, 1.2f, 3.4f});
    FilmStage whole(filled, kept), gathered(filled, plain);
    for (int second = 0; second < 2; ++second)
        EXPECT_TRUE(test::same_bytes(whole.cut(0.05f, second), gathered.cut(0.05f, second)));
    EXPECT_EQ(whole.statistics().cache.created, 0u);
    kept.cache = CacheUse::on;
    FilmStage everywhere(filled, kept);
    everywhere.cut(0.05f, 0);
    EXPECT_GT(everywhere.statistics().cache.created, 0u);

    // Where only the camera moves all light is static.
    test::SceneBuilder walk = test::furnished_room();
    walk.add_track(scene::TrackTarget::translation, walk.film().cameras[0].node, 3, {0, 10},
                   {2.0f, 1.6f, 3.8f, 2.4f, 1.6f, 3.8f});
    kept.cache = CacheUse::static_light;
    FilmStage walked(walk, kept);
    walked.cut(0.05f, 0);
    EXPECT_GT(walked.statistics().cache.created, 0u);
}

TEST(LightSplit, ShowNoShadowOfWhatIsGoneAndShowItAgainOnceItIsBackSlow) {
    const test::SceneBuilder b = parts_room({here, here, below, here}, false, {0.9f, 0.5f, 2.8f});
    FilmStage stage(b, parts_settings(true)), plain(b, parts_settings(false));
    stage.cut(0.05f, 0);
    const core::Radiance gone = plain.reference(2), back = plain.reference(3);
    ASSERT_GE(share_over(stage.cut(0.05f, 1), gone, 0.05f), 0.04) << "the box and its shadow count";
    EXPECT_LE(share_over(stage.cut(0.05f, 2), gone, 0.05f), 0.02);
    EXPECT_LE(share_over(stage.cut(0.05f, 3), back, 0.05f), 0.02);
}

TEST(LightSplit, FollowWhatAppearsSlow) {
    test::SceneBuilder b = test::furnished_room();
    b.add_point_light({0.6f, 2.4f, 3.0f}, 1.5f);
    const int box = b.add_box(low, high, b.add_material({0.5f, 0.5f, 0.5f}));
    b.add_track(scene::TrackTarget::visibility, b.film().objects[static_cast<std::size_t>(box)].node, 1, {0, 1, 2},
                {0, 1, 0});
    FilmStage stage(b, parts_settings(true)), plain(b, parts_settings(false));
    std::vector<core::Radiance> truth;
    for (int second = 0; second < 3; ++second) {
        truth.push_back(plain.reference(second));
        EXPECT_LE(share_over(stage.cut(0.05f, second), truth.back(), 0.05f), 0.02) << second;
    }
    EXPECT_GE(share_over(truth[0], truth[1], 0.05f), 0.02);
}

TEST(LightSplit, FollowWhatDeformsSlow) {
    test::SceneBuilder b = test::furnished_room();
    b.add_point_light({0.6f, 2.4f, 3.0f}, 1.5f);
    scene::Mesh mesh = test::SceneBuilder::box(low, high, false);
    scene::MorphTarget grown;
    for (const glm::vec3& p : mesh.positions) grown.positions.push_back({0, p.y > 0.2f ? 0.6f : 0.0f, 0});
    mesh.morph_targets.push_back(grown);
    const int body = b.add_object(b.add_mesh(mesh), b.add_material({0.5f, 0.5f, 0.5f}));
    b.film().objects[static_cast<std::size_t>(body)].morph_weights = {0};
    b.add_track(scene::TrackTarget::weights, b.film().objects[static_cast<std::size_t>(body)].node, 1, {0, 1, 2},
                {0, 1, 0});
    FilmStage stage(b, parts_settings(true)), plain(b, parts_settings(false));
    std::vector<core::Radiance> truth;
    for (int second = 0; second < 3; ++second) {
        truth.push_back(plain.reference(second));
        EXPECT_LE(share_over(stage.cut(0.05f, second), truth.back(), 0.05f), 0.02) << second;
    }
    EXPECT_GE(share_over(truth[0], truth[1], 0.05f), 0.02);
}

TEST(LightSplit, AreOfLampsWhereThereAreNoAnchors) {
    Settings s = parts_settings(true);
    s.vpls = 0;
    FilmStage stage(parts_room({here, beside, here}, true), s);
    for (int chunk = 0; chunk < 2; ++chunk) {
        stage.renderer().start_chunk(stage.at(0));
        for (int second = 0; second < 3; ++second)
            EXPECT_LE(share_over(stage.cut(0.05f, second), stage.reference(second), 0.05f), 0.02) << second;
    }
}

TEST(LightSplit, MeetACameraCutAndAnotherChunkSlow) {
    test::SceneBuilder b = parts_room({here, beside, here, beside}, true);
    b.add_camera({3.5f, 1.2f, 3.6f}, {0.5f, 0.2f, 2.0f}, 1.1f);
    b.film().shots = {{0, 0}, {2, 1}};
    FilmStage stage(b, parts_settings(true));
    for (int chunk = 0; chunk < 2; ++chunk) {
        stage.renderer().start_chunk(stage.at(chunk));
        for (int second = chunk; second < 4; ++second)
            EXPECT_LE(share_over(stage.cut(0.05f, second), stage.reference(second), 0.05f), 0.025) << second;
    }
    // What moves changes light at the points, wherever records lie.
    EXPECT_GT(stage.statistics().cache.served, 0u);
    EXPECT_EQ(stage.statistics().cache.at_record, 0u);
}

TEST(LightSplit, AreTheSameForAnyNumberOfThreadsSlow) {
    Settings s = parts_settings(true);
    s.format = {136, 80, 1.0f};
    s.direct_points = 32;
    s.vpls = 400;
    FilmStage one(parts_room({here, beside}, true), s), two(parts_room({here, beside}, true), s);
    for (int second = 0; second < 2; ++second) {
        core::Radiance a, b;
        {
            const parallel::ThreadLimit limit(1);
            a = one.cut(0.05f, second);
        }
        {
            const parallel::ThreadLimit limit(2);
            b = two.cut(0.05f, second);
        }
        EXPECT_TRUE(test::same_bytes(a, b)) << second;
    }
}

TEST(LightSplit, ThatRestCostNoRay) {
    FilmStage stage(parts_room({here, beside, beside, beside}), parts_settings(true));
    stage.cut(0.05f, 0);
    const core::Radiance moved = stage.cut(0.05f, 1);
    const std::uint64_t rays = stage.statistics().shadow_rays;
    EXPECT_TRUE(test::same_bytes(moved, stage.cut(0.05f, 2)));
    EXPECT_EQ(stage.statistics().shadow_rays, rays);
}

}  // namespace
}  // namespace render2mpeg::renderer
