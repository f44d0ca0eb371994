#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/tree/light_clusters.h"
#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {
namespace {

std::vector<LightPoint> random_lights(int count, std::uint64_t seed, float spread = 1.0f) {
    std::vector<LightPoint> lights;
    for (int i = 0; i < count; ++i) {
        const auto u = [&](std::uint64_t k) { return core::uniform(seed, static_cast<std::uint64_t>(i), k); };
        LightPoint p;
        p.position = spread * glm::vec3(u(0), u(1), u(2));
        p.normal = core::sample_sphere({u(3), u(4)});
        p.intensity = glm::vec3(u(5), u(6), u(7)) + 0.01f;
        p.disc2 = 1e-4f * (1 + u(8));
        p.id = static_cast<std::uint32_t>(i);
        lights.push_back(p);
    }
    return lights;
}

/// All lights below a node.
std::vector<std::uint32_t> leaves(const LightTree& tree, LightRef ref) {
    std::vector<std::uint32_t> found;
    std::vector<LightRef> stack{ref};
    while (!stack.empty()) {
        const LightRef r = stack.back();
        stack.pop_back();
        if (r.is_leaf()) {
            found.push_back(r.index());
        } else {
            stack.push_back(tree.child(r.index(), 0));
            stack.push_back(tree.child(r.index(), 1));
        }
    }
    return found;
}

int depth(const LightTree& tree, LightRef ref) {
    return ref.is_leaf()
               ? 0
               : 1 + std::max(depth(tree, tree.child(ref.index(), 0)), depth(tree, tree.child(ref.index(), 1)));
}

TEST(LightTree, HoldsEveryLightOnceAndBoundsWhatItHolds) {
    const auto lights = random_lights(2000, 1);
    const LightTree tree = build_light_tree(LightType::oriented, lights, 7);
    ASSERT_EQ(tree.lights.size(), lights.size());
    ASSERT_EQ(tree.nodes.size(), lights.size() - 1);
    EXPECT_EQ(leaves(tree, tree.root).size(), lights.size());
    const std::set<std::uint32_t> ids(tree.ids->begin(), tree.ids->end());
    EXPECT_EQ(ids.size(), lights.size());
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
        const LightNode& node = tree.nodes[n];
        const MiddleBox box = tree.box(n);
        const std::uint32_t representative = tree.representative(LightRef::inner(n));
        glm::dvec3 sum(0);
        bool holds_representative = false;
        for (const int side : {0, 1}) {
            for (const std::uint32_t i : leaves(tree, tree.child(n, side))) {
                const TreeLight& l = tree.lights[i];
                sum += l.intensity;
                holds_representative |= i == representative;
                for (int k = 0; k < 3; ++k) {
                    ASSERT_GE(l.position[k], box.middle[k] - box.half[k]);
                    ASSERT_LE(l.position[k], box.middle[k] + box.half[k]);
                }
                ASSERT_GE(glm::dot(l.normal(), node.axis.unpack()), node.cone.cosine() - 1e-6f);
                ASSERT_GE(l.disc2, node.disc2.least());
                ASSERT_LE(l.disc2, node.disc2.largest());
            }
        }
        ASSERT_TRUE(holds_representative);
        const bool one_child_keeps_it = (tree.representative(tree.child(n, 0)) == representative) !=
                                        (tree.representative(tree.child(n, 1)) == representative);
        ASSERT_TRUE(one_child_keeps_it);
        const glm::vec3 kept = tree.intensity(LightRef::inner(n));
        const double largest = std::max({sum.x, sum.y, sum.z});
        for (int k = 0; k < 3; ++k) {
            ASSERT_GE(kept[k], sum[k] * (1 - 1e-6));
            ASSERT_LE(kept[k], sum[k] + (0x1p-15 + 1e-6) * largest);
        }
    }
}

/// Greedy clustering without any short cut: always the cheapest of all pairs.
double greedy_cost(const std::vector<LightPoint>& points) {
    struct Member {
        std::vector<LightPoint> lights;
        double cost = 0;
    };
    std::vector<Member> light_trees;
    for (const LightPoint& p : points) light_trees.push_back({{p}, 0});
    const auto own_cost = [](const std::vector<LightPoint>& lights, glm::vec3 low, glm::vec3 high) {
        glm::vec3 lo(1e9f), hi(-1e9f), axis(0);
        double power = 0;
        for (const LightPoint& l : lights) {
            lo = glm::min(lo, l.position);
            hi = glm::max(hi, l.position);
            axis += l.normal;
            power += core::luminance(l.intensity);
        }
        float cosine = 1;
        const float length = glm::length(axis);
        for (const LightPoint& l : lights)
            cosine = std::min(cosine, length > 1e-6f ? glm::dot(l.normal, axis / length) : -1.0f);
        const glm::dvec3 d(hi - lo), c(high - low);
        return power * (glm::dot(d, d) + glm::dot(c, c) * (1.0 - cosine) * (1.0 - cosine));
    };
    glm::vec3 low(1e9f), high(-1e9f);
    for (const LightPoint& p : points) {
        low = glm::min(low, p.position);
        high = glm::max(high, p.position);
    }
    double total = 0;
    while (light_trees.size() > 1) {
        std::size_t a = 0, b = 1;
        double best = 1e300;
        for (std::size_t i = 0; i < light_trees.size(); ++i) {
            for (std::size_t j = i + 1; j < light_trees.size(); ++j) {
                std::vector<LightPoint> both = light_trees[i].lights;
                both.insert(both.end(), light_trees[j].lights.begin(), light_trees[j].lights.end());
                const double c = own_cost(both, low, high);
                if (c < best) {
                    best = c;
                    a = i;
                    b = j;
                }
            }
        }
        total += best;
        light_trees[a].lights.insert(light_trees[a].lights.end(), light_trees[b].lights.begin(),
                                     light_trees[b].lights.end());
        light_trees.erase(light_trees.begin() + static_cast<std::ptrdiff_t>(b));
    }
    return total;
}

TEST(LightTree, CostsHardlyMoreThanGreedyClusteringOfAllPairs) {
    double ratio = 0;
    const int trees = 4;
    for (int t = 0; t < trees; ++t) {
        // Lights on the walls of a room, as VPLs lie.
        auto lights = random_lights(64, 100 + static_cast<std::uint64_t>(t));
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const auto wall = static_cast<int>(i % 6);
            lights[i].position[wall % 3] = wall < 3 ? 0.0f : 1.0f;
            lights[i].normal = glm::vec3(0);
            lights[i].normal[wall % 3] = wall < 3 ? 1.0f : -1.0f;
        }
        ratio += cost_of(build_light_tree(LightType::oriented, lights, 1)) / greedy_cost(lights);
    }
    // The reference's cones lie about mean normals and are tighter than cones about cones.
    EXPECT_LT(ratio / trees, 1.3);
    EXPECT_GT(ratio / trees, 0.8);
}

TEST(LightTree, ChoosesRepresentativesInProportionToPower) {
    // A light of a quarter of the power represents the whole in a quarter of all seeds.
    auto lights = random_lights(2, 3);
    lights[0].intensity = glm::vec3(1);
    lights[1].intensity = glm::vec3(3);
    int chosen = 0;
    const int seeds = 4000;
    for (int s = 0; s < seeds; ++s) {
        const LightTree tree = build_light_tree(LightType::oriented, lights, static_cast<std::uint64_t>(s));
        chosen += (*tree.ids)[tree.representative(tree.root)] == 0 ? 1 : 0;
    }
    EXPECT_NEAR(chosen, 0.25 * seeds, 4 * std::sqrt(seeds * 0.25 * 0.75));
}

TEST(LightTree, OfNothingOrOneOrBlackLightsIsWhole) {
    EXPECT_TRUE(build_light_tree(LightType::oriented, {}, 1).empty());
    auto lights = random_lights(3, 4);
    for (LightPoint& l : lights) l.intensity = glm::vec3(0);
    EXPECT_TRUE(build_light_tree(LightType::oriented, lights, 1).empty());
    lights[1].intensity = {0, 1, 0};
    const LightTree one = build_light_tree(LightType::oriented, lights, 1);
    ASSERT_EQ(one.lights.size(), 1u);
    EXPECT_TRUE(one.root.is_leaf());
    EXPECT_EQ(one.intensity(one.root), glm::vec3(0, 1, 0));
    lights[0].intensity = glm::vec3(std::nanf(""));
    lights[2].position.x = std::numeric_limits<float>::infinity();
    lights[2].intensity = glm::vec3(1);
    EXPECT_EQ(build_light_tree(LightType::oriented, lights, 1).lights.size(), 1u);
}

TEST(LightTree, MergesCoincidentLightsIntoOneOfTheirSum) {
    std::vector<LightPoint> lights(100000, random_lights(1, 5).front());
    for (LightPoint& l : lights) l.intensity = {1, 2, 4};
    const LightTree tree = build_light_tree(LightType::oriented, lights, 1);
    ASSERT_EQ(tree.lights.size(), 1u);
    EXPECT_EQ(tree.lights.front().intensity, glm::vec3(100000, 200000, 400000));
    // Facing apart they stay apart, at any depth that can be walked.
    for (std::size_t i = 0; i < 2000; ++i)
        lights[i].normal = core::sample_sphere({core::halton(0, i), core::halton(1, i)});
    lights.resize(2000);
    const LightTree fan = build_light_tree(LightType::oriented, lights, 1);
    EXPECT_EQ(fan.lights.size(), 2000u);
    EXPECT_LT(depth(fan, fan.root), 64);
}

TEST(LightTreeSlow, MergesAMillionCoincidentLightsIntoOneOfTheirSum) {
    std::vector<LightPoint> lights(1'000'000, random_lights(1, 5).front());
    for (LightPoint& l : lights) l.intensity = {1, 2, 4};
    const LightTree tree = build_light_tree(LightType::oriented, lights, 1);
    ASSERT_EQ(tree.lights.size(), 1u);
    // Whole numbers that single precision still counts one by one.
    EXPECT_EQ(tree.lights.front().intensity, glm::vec3(1e6f, 2e6f, 4e6f));
}

TEST(LightTree, KeepsFaintLightsBesideBlindingOnes) {
    auto lights = random_lights(1000, 6);
    for (std::size_t i = 0; i < lights.size(); ++i) lights[i].intensity = glm::vec3(i % 2 == 0 ? 1e12f : 1e-12f);
    const LightTree tree = build_light_tree(LightType::oriented, lights, 1);
    ASSERT_EQ(tree.lights.size(), 1000u);
    EXPECT_NEAR(tree.intensity(tree.root).x / 5e14, 1.0, 1e-5);
    int faint = 0;
    for (const TreeLight& l : tree.lights) faint += l.intensity.x == 1e-12f ? 1 : 0;
    EXPECT_EQ(faint, 500);
}

TEST(LightTree, IsTheSameShapeForTwiceTheLightAndTwiceTheScene) {
    auto lights = random_lights(500, 8);
    const LightTree tree = build_light_tree(LightType::oriented, lights, 9);
    for (LightPoint& l : lights) {
        l.intensity *= 1024.0f;
        l.position *= 0.0625f;
    }
    const LightTree scaled = build_light_tree(LightType::oriented, lights, 9);
    ASSERT_EQ(tree.nodes.size(), scaled.nodes.size());
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const auto n = static_cast<std::uint32_t>(i);
        EXPECT_EQ(tree.intensity(LightRef::inner(n)) * 1024.0f, scaled.intensity(LightRef::inner(n)));
        EXPECT_EQ(tree.box(n).middle * 0.0625f, scaled.box(n).middle);
        EXPECT_EQ(tree.nodes[i].first_represents, scaled.nodes[i].first_represents);
    }
}

TEST(LightTree, RoundsDiscsAndConesOutwardsByLittle) {
    for (std::uint32_t i = 0; i < 3000; ++i) {
        const float disc2 = std::exp2(60.0f * core::uniform(8, i, 0) - 30.0f);
        const Disc2Range range(disc2, disc2);
        ASSERT_LE(range.least(), disc2);
        ASSERT_GT(range.least(), 0.992f * disc2);
        ASSERT_GE(range.largest(), disc2);
        ASSERT_LT(range.largest(), 1.008f * disc2);
        const float angle = 3.14159265f * core::uniform(8, i, 1) * (i % 2 == 0 ? 1.0f : 0.01f);
        const float packed = std::acos(std::clamp(PackedCone(angle).cosine(), -1.0f, 1.0f));
        ASSERT_GE(packed, angle - 4e-4f) << "the arc cosine's own rounding";
        ASSERT_LT(packed, angle + (angle < 3.0f ? 1e-3f : 1.3e-2f)) << angle;
        ASSERT_LE(PackedCone(angle).cosine(), std::cos(angle) + 1e-7f);
    }
    EXPECT_EQ(Disc2Range(0, std::numeric_limits<float>::infinity()).largest(), std::numeric_limits<float>::infinity());
    EXPECT_EQ(Disc2Range(0, 0).largest(), 0.0f);
    EXPECT_NEAR(PackedCone(3.14159265f).cosine(), -1.0f, 2e-7f);
}

TEST(LightTree, Takes80BytesPerLight) {
    const LightTree tree = build_light_tree(LightType::oriented, random_lights(50000, 10), 1);
    EXPECT_LE(tree.bytes(), 80u * 50000u);
    EXPECT_GE(tree.bytes(), 79u * 50000u);
}

TEST(LightTree, PairsUpALatticeOfEqualLightsInLogarithmicDepth) {
    std::vector<LightPoint> lights;
    for (int i = 0; i < 4096; ++i) {
        LightPoint p;
        p.position = {static_cast<float>(i % 64), static_cast<float>(i / 64), 0};
        p.intensity = glm::vec3(1);
        p.id = static_cast<std::uint32_t>(i);
        lights.push_back(p);
    }
    const LightTree tree = build_light_tree(LightType::oriented, lights, 1);
    EXPECT_LE(depth(tree, tree.root), 24);
    EXPECT_GE(depth(tree, tree.root), 12);
}

}  // namespace
}  // namespace render2mpeg::renderer
