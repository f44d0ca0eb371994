#include "renderer/tree/light_trees.h"

#include <gtest/gtest.h>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/tree/light_clusters.h"
#include "tests/renderer/lighting.h"
#include "tests/renderer/virtual_light_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::hall;
using test::VirtualLightStage;

std::vector<LightPoint> forest_lights(int count, std::uint64_t seed) {
    std::vector<LightPoint> lights;
    for (int i = 0; i < count; ++i) {
        const auto u = [&](std::uint64_t k) { return core::uniform(seed, static_cast<std::uint64_t>(i), k); };
        LightPoint p;
        p.position = {u(0), u(1), u(2)};
        p.normal = core::sample_sphere({u(3), u(4)});
        p.intensity = glm::vec3(u(5), u(6), u(7)) + 0.01f;
        p.disc2 = 1e-4f * (1 + u(8));
        p.id = static_cast<std::uint32_t>(i);
        lights.push_back(p);
    }
    return lights;
}

/// Ids of all trees' lights, in the trees' order.
std::vector<std::uint32_t> order_of(const LightTrees& light_trees) {
    std::vector<std::uint32_t> order;
    for (const LightTree& tree : light_trees.trees)
        if (tree.ids) order.insert(order.end(), tree.ids->begin(), tree.ids->end());
    return order;
}

/// Lets `persistent` rebuild its trees; whether it did.
bool rebuilds(PersistentLightTrees& persistent, std::span<const LightPoint> now) {
    const auto before = order_of(persistent.at(now));
    return order_of(persistent.at(now, true)) != before;
}

void expect_same(const LightTree& a, const LightTree& b) {
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    ASSERT_EQ(a.lights.size(), b.lights.size());
    EXPECT_EQ(a.root, b.root);
    for (std::size_t i = 0; i < a.nodes.size(); ++i) {
        const LightNode &x = a.nodes[i], &y = b.nodes[i];
        const auto n = static_cast<std::uint32_t>(i);
        EXPECT_EQ(a.box(n).middle, b.box(n).middle);
        EXPECT_EQ(a.box(n).half, b.box(n).half);
        EXPECT_EQ(a.intensity(LightRef::inner(n)), b.intensity(LightRef::inner(n)));
        for (const int side : {0, 1}) EXPECT_EQ(a.child(n, side), b.child(n, side));
        EXPECT_EQ(x.cone, y.cone);
        EXPECT_EQ(x.axis.unpack(), y.axis.unpack());
        EXPECT_EQ(x.first_represents, y.first_represents);
        EXPECT_EQ(x.disc2, y.disc2);
    }
    for (std::size_t i = 0; i < a.lights.size(); ++i) {
        EXPECT_EQ(a.lights[i].position, b.lights[i].position);
        EXPECT_EQ(a.lights[i].intensity, b.lights[i].intensity);
    }
    EXPECT_EQ(*a.ids, *b.ids);
}

TEST(LightTreeUpdate, WithTheSameLightsChangesNoBit) {
    const auto lights = forest_lights(3000, 1);
    const LightTree tree = build_persistent_tree(LightType::oriented, lights, 7);
    LightTree updated = tree;
    update_light_tree(updated, lights, 7);
    expect_same(tree, updated);
}

TEST(LightTreeUpdate, DependsOnTheLastLightsAlone) {
    const auto lights = forest_lights(500, 1), others = forest_lights(500, 2);
    const LightTree tree = build_persistent_tree(LightType::oriented, lights, 7);
    LightTree once = tree, twice = tree;
    update_light_tree(once, others, 7);
    update_light_tree(twice, forest_lights(400, 3), 7);
    update_light_tree(twice, others, 7);
    expect_same(once, twice);
}

TEST(LightTreeUpdate, BoundsLightsThatHaveMovedOrGoneOut) {
    const auto lights = forest_lights(1000, 1);
    auto others = forest_lights(1000, 2);
    others.erase(others.begin() + 100, others.begin() + 300);
    LightTree tree = build_persistent_tree(LightType::oriented, lights, 7);
    update_light_tree(tree, others, 7);
    ASSERT_EQ(tree.lights.size(), 1000u);
    glm::dvec3 sum(0), expected(0);
    for (const LightPoint& p : others) expected += p.intensity;
    // From the last node up, so that children come before parents: every light below a node is held by it.
    std::vector<std::vector<std::uint32_t>> below(tree.nodes.size());
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        const LightNode& node = tree.nodes[n];
        const auto index = static_cast<std::uint32_t>(n);
        const MiddleBox box = tree.box(index);
        for (const int side : {0, 1}) {
            const LightRef child = tree.child(index, side);
            if (child.is_leaf())
                below[n].push_back(child.index());
            else
                below[n].insert(below[n].end(), below[child.index()].begin(), below[child.index()].end());
        }
        for (const std::uint32_t i : below[n]) {
            const TreeLight& l = tree.lights[i];
            if (!(core::luminance(l.intensity) > 0)) continue;  // it may lie anywhere
            for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(l.position[k] - box.middle[k]), box.half[k]);
            ASSERT_GE(glm::dot(l.normal(), node.axis.unpack()), node.cone.cosine() - 1e-6f);
        }
        // A light that is out represents nothing that shines.
        if (core::luminance(tree.intensity(LightRef::inner(index))) > 0) {
            ASSERT_GT(core::luminance(
                          tree.lights[tree.representative(LightRef::inner(static_cast<std::uint32_t>(n)))].intensity),
                      0.0f);
        }
    }
    for (const TreeLight& l : tree.lights) sum += l.intensity;
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(sum[k] / expected[k], 1.0, 1e-5);
        EXPECT_NEAR(tree.intensity(tree.root)[k] / expected[k], 1.0, 1e-4);
    }
}

TEST(LightTreeUpdate, ChangesRepresentativesAsRarelyAsSharesAllow) {
    // When each light changes by up to a tenth, a representative that is chosen by its share must change in one of some
    // twenty nodes; a tree that rolled new dice would change half of them.
    auto lights = forest_lights(2000, 1);
    const LightTree tree = build_persistent_tree(LightType::oriented, lights, 7);
    for (std::size_t i = 0; i < lights.size(); ++i) lights[i].intensity *= 0.9f + 0.2f * core::uniform(9, i);
    LightTree updated = tree;
    update_light_tree(updated, lights, 7);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i)
        changed += (tree.nodes[i].first_represents & 1u) != (updated.nodes[i].first_represents & 1u) ? 1 : 0;
    EXPECT_LT(changed, tree.nodes.size() / 10);
    EXPECT_GT(changed, 0u);
}

/// Clusters that light trees takes to light places on the floor and a wall, all told.
int clusters(const VirtualLightStage& stage, LightTrees& light_trees) {
    light_trees.point_clamp = {0.25f};
    Gatherer gatherer(light_trees, stage.posed_scene().tracer());
    int sum = 0;
    for (std::uint32_t triangle = 0; triangle < 12; ++triangle) {
        for (const float u : {0.1f, 0.3f, 0.6f}) {
            GatherPoint point;
            point.point =
                stage.posed_scene().surface_at({0, triangle, u, 0.3f}, stage.posed_scene().front_normal(0, triangle));
            const GatherPoint* const points[] = {&point};
            GatherLanes lanes;
            fill(lanes, points);
            GroupTolerance tolerance{};
            std::fill(std::begin(tolerance.relative), std::end(tolerance.relative), 0.02f);
            GatheredLight light;
            gatherer.gather(lanes, tolerance, {8, 100000}, light);
            sum += light.direct_clusters + light.indirect_clusters;
        }
    }
    return sum;
}

/// The hall with three glowing balls that pass each other.
test::SceneBuilder busy_hall() {
    test::SceneBuilder b = hall();
    for (int i = 0; i < 3; ++i) {
        const int ball =
            b.add_sphere({0, 0, 0}, 0.5f, b.add_emitter(glm::vec3(0.8f, 0.3f, 0.2f * static_cast<float>(i))), 8);
        std::vector<glm::vec3> places;
        for (int k = 0; k <= 8; ++k)
            places.push_back({1.5f + 0.5f * static_cast<float>((k + 3 * i) % 4), 0.6f + static_cast<float>(i),
                              1 + static_cast<float>((k * (i + 2)) % 9)});
        b.move_object(ball, places);
    }
    return b;
}

TEST(PersistentLightTreesSlow, NeedsHardlyMoreClustersIn200FramesWithThingsThatMove) {
    const VirtualLightSettings none{1, 1};
    VirtualLightStage stage(busy_hall(), none, 1500);
    PersistentLightTrees persistent(stage.points().average(), 1);
    double updated_clusters = 0, fresh_clusters = 0;
    int rebuilt = 0;
    for (int frame = 0; frame < 200; frame += 15) {
        stage.pose(frame / 25.0);
        rebuilt += rebuilds(persistent, stage.direct()) ? 1 : 0;
        LightTrees updated = persistent.at(stage.direct());
        LightTrees fresh = test::build_light_trees(stage.direct(), {}, 1);
        const int mine = clusters(stage, updated), other = clusters(stage, fresh);
        EXPECT_LE(mine, 1.5 * other) << frame;
        updated_clusters += mine;
        fresh_clusters += other;
    }
    EXPECT_LE(updated_clusters / fresh_clusters, 1.1);
    EXPECT_GE(updated_clusters / fresh_clusters, 0.85);
    // Balls that part ways may fit their tree badly once or twice, not all the time.
    EXPECT_LE(rebuilt, 2);
}

TEST(PersistentLightTrees, PlansATreeAnewThatFitsItsLightsNoMoreOnlyWhereItMay) {
    // Lights that all change places.
    const auto usual = forest_lights(1000, 1), now = forest_lights(1000, 2);
    PersistentLightTrees persistent(usual, 1);
    EXPECT_FALSE(rebuilds(persistent, usual));
    const PersistentLightTrees before = persistent;
    EXPECT_TRUE(rebuilds(persistent, now));
    EXPECT_EQ(order_of(PersistentLightTrees(before).at(now)), order_of(PersistentLightTrees(before).at(usual)));
    const LightTrees other = persistent.at(now);
    const LightTree fresh = build_light_tree(LightType::oriented, now, 1);
    EXPECT_LE(cost_of(other.trees.front()), 1.1 * cost_of(fresh));
    EXPECT_GE(cost_of(other.trees.front()), 0.5 * cost_of(fresh));
    // From then on it stays: frames between do not alternate between two trees.
    auto later = now;
    for (LightPoint& p : later) p.intensity *= 1.5f;
    const LightTrees next = persistent.at(later, false);
    const auto &x = other.trees.front(), &y = next.trees.front();
    ASSERT_EQ(x.lights.size(), y.lights.size());
    EXPECT_EQ(*x.ids, *y.ids);
}

/// Two things of 200 lights each: one in [0, 1]^3, and one like it far along x.
std::vector<LightPoint> two_things(float distance) {
    auto lights = forest_lights(200, 1);
    for (LightPoint p : forest_lights(200, 2)) {
        p.position.x += distance;
        p.id += 200;
        lights.push_back(p);
    }
    return lights;
}

TEST(PersistentLightTrees, DoesNotLetWhatIsHiddenWidenItsBounds) {
    // The tree is built with a thing a kilometre away, which then is hidden.
    const auto usual = two_things(1000.0f);
    auto now = usual;
    now.erase(now.begin() + 200, now.end());
    PersistentLightTrees persistent(usual, 1);
    EXPECT_FALSE(rebuilds(persistent, now));
    const LightTrees light_trees = persistent.at(now);
    const LightTree& tree = light_trees.trees.front();
    const LightTree fresh = build_light_tree(LightType::oriented, now, 1);
    ASSERT_FALSE(tree.root.is_leaf());
    const MiddleBox root = tree.box(tree.root.index());
    for (int k = 0; k < 3; ++k) {
        EXPECT_LE(root.middle[k] + root.half[k], 1.001f);
        EXPECT_GE(root.middle[k] - root.half[k], -0.001f);
    }
    EXPECT_LE(cost_of(tree), 1.3 * cost_of(fresh));
    EXPECT_GE(cost_of(tree), 0.9 * cost_of(fresh));
}

TEST(PersistentLightTrees, PlansAgainByWhatIsThereAndKeepsRoomForWhatIsHidden) {
    const auto usual = two_things(1000.0f);
    auto now = forest_lights(400, 3);
    now.erase(now.begin() + 100, now.begin() + 300);
    PersistentLightTrees persistent(usual, 1);
    EXPECT_TRUE(rebuilds(persistent, now));
    const LightTrees all = persistent.at(usual);
    glm::dvec3 sum(0), expected(0);
    for (const LightPoint& p : usual) expected += p.intensity;
    for (const TreeLight& l : all.trees.front().lights) sum += l.intensity;
    EXPECT_NEAR(sum.x / expected.x, 1.0, 1e-6);
}

TEST(PersistentLightTrees, KeepsFourAndAQuarterBytesOfAPlanForEachLight) {
    const auto usual = forest_lights(10000, 1);
    const PersistentLightTrees persistent(usual, 1);
    EXPECT_LE(persistent.bytes(), 43u * 1000u);
    EXPECT_GE(persistent.bytes(), 42u * 1000u);
}

TEST(PersistentLightTrees, HasNoTreeForWhatIsDark) {
    const auto usual = forest_lights(100, 1);
    PersistentLightTrees persistent(usual, 1);
    const LightTrees dark = persistent.at({});
    for (const LightTree& tree : dark.trees) EXPECT_TRUE(tree.empty());
    const LightTrees lit = persistent.at(usual);
    EXPECT_EQ(lit.trees.front().lights.size(), 100u);
}

}  // namespace
}  // namespace render2mpeg::renderer
