#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "core/sampling.h"
#include "renderer/cut/gather_groups.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

TEST(RepresentativeSets, AreChosenByPowerEachAndStratifiedTogether) {
    // Of two lights the first has a quarter of the power: every set takes it in a quarter of all seeds, and a single
    // one in every seed.
    LightPoint lights[2];
    lights[0].position = {0, 0, 0};
    lights[0].intensity = glm::vec3(1);
    lights[1].position = {1, 0, 0};
    lights[1].intensity = glm::vec3(3);
    lights[1].id = 1;
    const int seeds = 4000;
    int taken[representative_sets] = {};
    for (int s = 0; s < seeds; ++s) {
        const LightTree tree = build_light_tree(LightType::oriented, lights, static_cast<std::uint64_t>(s));
        unsigned of_first = 0;
        for (int k = 0; k < representative_sets; ++k)
            of_first |= (*tree.ids)[tree.representative(tree.root, k)] == 0 ? 1u << k : 0u;
        ASSERT_EQ(std::popcount(of_first), 1);
        for (int k = 0; k < representative_sets; ++k) taken[k] += of_first >> k & 1u;
    }
    for (const int t : taken) EXPECT_NEAR(t, 0.25 * seeds, 4 * std::sqrt(seeds * 0.25 * 0.75));
}

TEST(RepresentativeSets, DifferAndKeepTheirRepresentativeInOneChild) {
    std::vector<LightPoint> lights(300);
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        lights[i].position = {core::uniform(1, i, 0), core::uniform(1, i, 1), core::uniform(1, i, 2)};
        lights[i].intensity = glm::vec3(0.1f + core::uniform(1, i, 3));
        lights[i].id = i;
    }
    const LightTree tree = build_light_tree(LightType::oriented, lights, 3);
    std::set<std::uint32_t> of_root;
    for (int k = 0; k < representative_sets; ++k) {
        of_root.insert(tree.representative(tree.root, k));
        for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
            const LightRef node = LightRef::inner(n);
            const LightRef keeps = tree.child(n, tree.first_represents(node, k) ? 0 : 1);
            ASSERT_EQ(tree.representative(node, k), tree.representative(keeps, k));
        }
    }
    EXPECT_GE(of_root.size(), 3u);
}

TEST(RepresentativeSets, AreAdoptedWhereWalkingDownEnds) {
    std::vector<LightPoint> lights(300);
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        lights[i].position = {core::uniform(1, i, 0), core::uniform(1, i, 1), core::uniform(1, i, 2)};
        lights[i].intensity = glm::vec3(0.1f + core::uniform(1, i, 3));
        lights[i].id = i;
    }
    LightTree tree = build_persistent_tree(LightType::oriented, lights, 3);
    const auto expect_seats = [&tree] {
        for (int k = 0; k < representative_sets; ++k) {
            for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
                const LightRef node = LightRef::inner(n);
                const LightRef other = tree.child(n, tree.first_represents(node, k) ? 1 : 0);
                ASSERT_EQ(tree.other_representative(node, tree.representative(node, k), k),
                          tree.representative(other, k))
                    << n << " in " << k;
            }
        }
    };
    expect_seats();
    const std::uint32_t before = tree.representative(tree.root, 0);
    for (LightPoint& l : lights) l.intensity = glm::vec3(l.id == (*tree.ids)[before] ? 0.0f : 1.0f);
    update_light_tree(tree, lights, 3);
    expect_seats();
    EXPECT_NE(tree.representative(tree.root, 0), before);
}

/// Points on a floor under many lamps, some of them behind a wall.
struct WalledFloor {
    WalledFloor() : stage(room()), lamps(stage.direct_points(16, 1)) {
        for (int i = 0; i < lane_count; ++i)
            points.push_back(stage.point_at(
                0, 0, {0.3f + 0.02f * static_cast<float>(i % 4), 0.3f + 0.02f * static_cast<float>(i / 4)}, {0, 1, 0}));
        const GatherPoint* pointers[lane_count];
        for (std::size_t i = 0; i < lane_count; ++i) pointers[i] = &points[i];
        fill(lanes, pointers);
    }
    static SceneBuilder room() {
        SceneBuilder b;
        const int grey = b.add_material(glm::vec3(0.5f));
        b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, grey);
        b.add_quad({0.1f, 0, -1}, {0, 0.4f, 0}, {0, 0, 2}, grey);
        for (std::uint64_t i = 0; i < 64; ++i) {
            const auto u = [&](std::uint64_t k) { return core::uniform(5, i, k); };
            b.add_point_light({2 * u(0) - 1, 0.2f + 0.5f * u(1), 2 * u(2) - 1}, 0.5f + u(3));
        }
        return b;
    }
    /// Irradiance of the first point, by a cut of a fixed shape: tolerances that no light moves.
    double by_cut(std::uint64_t seed, int set) {
        LightTrees light_trees = test::build_light_trees(lamps, {}, seed);
        light_trees.point_clamp = GeometryClamp::none();
        GroupTolerance tolerance{};
        std::fill(std::begin(tolerance.absolute), std::end(tolerance.absolute), 1e-6f);
        lanes.set = set;
        GatheredLight light;
        Gatherer(light_trees, stage.posed_scene().tracer()).gather(lanes, tolerance, {12, 12}, light);
        return light.direct.at(0).y;
    }
    double by_all() {
        LightTrees light_trees = test::build_light_trees(lamps, {}, 1);
        light_trees.point_clamp = GeometryClamp::none();
        GatheredLight light;
        Gatherer(light_trees, stage.posed_scene().tracer()).gather_all(lanes, light);
        return light.direct.at(0).y;
    }
    LitStage stage;
    std::vector<LightPoint> lamps;
    std::vector<GatherPoint> points;
    GatherLanes lanes;
};

TEST(RepresentativeSets, GiveCutsWithLittleBiasWhoseMeanErrsLess) {
    WalledFloor floor;
    const double truth = floor.by_all();
    ASSERT_GT(truth, 0.1);
    const int seeds = 300;
    double sum = 0, squares = 0, mean_squares = 0;
    for (std::uint64_t s = 0; s < seeds; ++s) {
        double mean = 0;
        for (int k = 0; k < 4; ++k) {
            const double error = floor.by_cut(s, k) / truth - 1;
            mean += error / 4;
            squares += error * error / 4;
        }
        sum += mean;
        mean_squares += mean * mean;
    }
    const double rms = std::sqrt(squares / seeds), rms_of_mean = std::sqrt(mean_squares / seeds);
    EXPECT_GT(rms, 0.01);
    // The parts of a cluster share one visibility, which is a bias where shadows part them.
    EXPECT_LT(std::abs(sum / seeds), 0.01);
    // Independent sets would halve it.
    EXPECT_LT(rms_of_mean, 0.5 * rms);
    EXPECT_GT(rms_of_mean, 0.05 * rms);
}

TEST(GatherGroups, PartATileByThePlaceOfPixelsInThePattern) {
    GatherTile tile(tile_size * tile_size);
    for (std::uint16_t i = 0; i < tile.size(); ++i) {
        tile[i].pixel = i;
        tile[i].point.position = {0.01f * static_cast<float>(i % tile_size), 0.01f * static_cast<float>(i / tile_size),
                                  0};
        tile[i].point.shading_normal = tile[i].point.geometric_normal = {0, 0, 1};
    }
    for (const int sets : {1, representative_sets}) {
        const auto groups = group_points(tile, {0, 0, 10}, sets);
        EXPECT_EQ(groups.size(), tile.size() / lane_count);
        std::vector<int> set_of(tile.size(), -1);
        for (const GatherGroup& group : groups) {
            for (const std::uint32_t i : group.points) {
                ASSERT_EQ(set_of[i], -1);
                set_of[i] = group.set;
            }
        }
        const int period = sets == representative_sets ? 2 : 1;
        for (int y = 0; y + period < tile_size; ++y) {
            for (int x = 0; x + period < tile_size; ++x) {
                std::set<int> seen;
                for (int i = 0; i < period * period; ++i)
                    seen.insert(set_of[static_cast<std::size_t>((y + i / period) * tile_size + x + i % period)]);
                ASSERT_EQ(static_cast<int>(seen.size()), sets);
                ASSERT_EQ(set_of[static_cast<std::size_t>(y * tile_size + x)],
                          set_of[static_cast<std::size_t>((y + period) * tile_size + x + period)]);
            }
        }
    }
}

TEST(RepresentativeSets, AreKeptByPointsThatSmallGroupsLeaveOver) {
    // Two pixels of each 4x4 square are there, of sets 0 and 3: no block of a set is full, but sixteen of each set are
    // near in the tile.
    GatherTile tile;
    for (int y = 0; y < tile_size; y += 4)
        for (int x = 0; x < tile_size; x += 4)
            for (const int i : {0, 1}) {
                GatherPoint p;
                p.pixel = static_cast<decltype(p.pixel)>((y + i) * tile_size + x + i);
                p.point.position = {0.01f * static_cast<float>(x + i), 0.01f * static_cast<float>(y + i), 0};
                p.point.shading_normal = p.point.geometric_normal = {0, 0, 1};
                tile.push_back(p);
            }
    const auto groups = group_points(tile, {0, 0, 10}, 4);
    ASSERT_EQ(groups.size(), 2u);
    for (const GatherGroup& group : groups) {
        EXPECT_EQ(group.points.size(), 16u);
        for (const std::uint32_t i : group.points) EXPECT_EQ(tile[i].pixel % 2 != 0 ? 3 : 0, group.set);
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
