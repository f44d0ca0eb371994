#include "renderer/tree/light_kernels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/surface/bsdf.h"

namespace render2mpeg::renderer {
namespace {

constexpr LightType types[] = {LightType::oriented, LightType::punctual, LightType::directional};

float kernel_dice(std::uint64_t seed, std::uint64_t a, std::uint64_t b) {
    return core::uniform(seed, a, b);
}

/// Sixteen points on differently turned surfaces, half of them with a lobe where `glossy`.
std::vector<GatherPoint> points_at_random(std::uint64_t seed, bool glossy) {
    std::vector<GatherPoint> points(lane_count);
    for (std::uint64_t i = 0; i < points.size(); ++i) {
        SurfacePoint& p = points[i].point;
        p.position = {kernel_dice(seed, i, 0), kernel_dice(seed, i, 1), kernel_dice(seed, i, 2)};
        p.shading_normal = p.geometric_normal = core::sample_sphere({kernel_dice(seed, i, 3), kernel_dice(seed, i, 4)});
        p.outgoing =
            core::sample_cosine_hemisphere(p.shading_normal, {kernel_dice(seed, i, 5), kernel_dice(seed, i, 6)});
        p.bsdf.diffuse = {kernel_dice(seed, i, 7), kernel_dice(seed, i, 8), kernel_dice(seed, i, 9)};
        if (glossy && i % 2 == 0) {
            p.bsdf.f0 = {0.04f + 0.9f * kernel_dice(seed, i, 10), 0.04f, 0.04f + 0.5f * kernel_dice(seed, i, 11)};
            p.bsdf.alpha = std::pow(10.0f, -2.0f * kernel_dice(seed, i, 12));
            if (i % 4 == 0) p.bsdf.f90 = glm::vec3(1) + p.bsdf.f0;
        }
        points[i].weight = {1, kernel_dice(seed, i, 13), 0.5f};
    }
    return points;
}

void fill_from(const std::vector<GatherPoint>& points, GatherLanes& lanes) {
    const GatherPoint* pointers[lane_count];
    for (std::size_t i = 0; i < points.size(); ++i) pointers[i] = &points[i];
    fill(lanes, std::span<const GatherPoint* const>(pointers, points.size()));
}

std::vector<LightPoint> lights_at_random(LightType type, int count, std::uint64_t seed) {
    const glm::vec3 middle =
        1.5f * core::sample_sphere({kernel_dice(seed, 1000, 0), kernel_dice(seed, 1000, 1)}) + 0.5f;
    const float size = std::pow(10.0f, -2.0f * kernel_dice(seed, 1000, 2));
    const glm::vec3 axis = core::sample_sphere({kernel_dice(seed, 1000, 3), kernel_dice(seed, 1000, 4)});
    const float turn = kernel_dice(seed, 1000, 5);
    std::vector<LightPoint> lights;
    for (int i = 0; i < count; ++i) {
        const auto u = [&](std::uint64_t k) { return kernel_dice(seed, static_cast<std::uint64_t>(i), k); };
        LightPoint p;
        p.position = middle + size * glm::vec3(u(0) - 0.5f, u(1) - 0.5f, u(2) - 0.5f);
        p.normal = core::normalize_or(axis + turn * core::sample_sphere({u(3), u(4)}), axis);
        p.intensity = {u(5), u(6), u(7)};
        p.disc2 = 1e-3f * u(8) * u(8);
        p.id = static_cast<std::uint32_t>(i);
        p.type = type;
        if (type == LightType::punctual) {
            p.range = i % 3 == 0 ? 1.0f + u(9) : 0.0f;
            const float outer = 0.9f * u(10), inner = outer + (1 - outer) * (0.1f + 0.9f * u(11));
            if (i % 2 != 0) p.spot = {1 / (inner - outer), -outer / (inner - outer)};
            p.disc2 = 0;
        }
        lights.push_back(p);
    }
    return lights;
}

/// Luminance that all lights below a node add to each lane, all visible.
void sum_below(const GatherLanes& lanes, const LightTree& tree, LightRef ref, GeometryClamp clamp, Lanes& sum) {
    if (!ref.is_leaf()) {
        sum_below(lanes, tree, tree.child(ref.index(), 0), clamp, sum);
        sum_below(lanes, tree, tree.child(ref.index(), 1), clamp, sum);
        return;
    }
    LightLanes unit;
    evaluate_light(lanes, tree.type, tree.lights[ref.index()], tree.spot(ref.index()), clamp, unit);
    add_luminance(lanes, unit_light(lanes, unit), tree.lights[ref.index()].intensity, sum);
}

TEST(NodeBound, IsNeverBelowTheSumOfItsLights) {
    int violations = 0, compared = 0;
    double log_slack[3] = {};
    int counted[3] = {};
    for (std::uint64_t seed = 0; seed < 700; ++seed) {
        for (const LightType type : types) {
            using ByRays = GeometryClamp::ByRays;
            const ByRays by_rays[] = {ByRays::by_size, ByRays::none, ByRays::all, ByRays::none};
            for (const GeometryClamp clamp : {GeometryClamp{0.02f, by_rays[seed % 4]}, GeometryClamp::none()}) {
                const LightTree tree = build_light_tree(type, lights_at_random(type, 12, seed), seed);
                GatherLanes lanes;
                fill_from(points_at_random(seed + 5000, seed % 2 == 0), lanes);
                for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
                    Lanes bound, sum = {};
                    bound_node(lanes, tree, n, clamp, bound);
                    sum_below(lanes, tree, LightRef::inner(n), clamp, sum);
                    for (int i = 0; i < lane_count; ++i) {
                        ++compared;
                        violations += sum[i] > bound[i] * 1.0005f + 1e-6f ? 1 : 0;
                        ASSERT_TRUE(std::isfinite(bound[i]) || clamp.scale > 1.0f);
                        if (sum[i] < 1e-3f || !std::isfinite(bound[i])) continue;
                        log_slack[static_cast<int>(type)] += std::log(bound[i] / sum[i]);
                        ++counted[static_cast<int>(type)];
                    }
                }
            }
        }
    }
    EXPECT_GT(compared, 500000);
    EXPECT_EQ(violations, 0);
    // Geometric mean of bound over sum, half of the points glossy; spots stop light that their bound cannot know of.
    const double allowed[] = {2.7, 3.5, 2.1};
    for (int f = 0; f < 3; ++f) {
        ASSERT_GT(counted[f], 1000);
        EXPECT_LT(std::exp(log_slack[f] / counted[f]), allowed[f]) << f;
    }
}

TEST(NodeBound, CountsColourOfLobesAsOfDiffuseLight) {
    // The luminance of a blue lamp is a fourteenth of its light; half of its Cb is more, in a lobe as on a wall.
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        std::vector<LightPoint> lights = lights_at_random(LightType::oriented, 12, seed);
        for (LightPoint& p : lights) p.intensity = {0, 0, p.intensity.z};
        const LightTree tree = build_light_tree(LightType::oriented, lights, seed);
        auto points = points_at_random(seed + 5000, true);
        for (GatherPoint& p : points) p.point.bsdf.diffuse = glm::vec3(0);  // the lobe alone
        GatherLanes lanes;
        fill_from(points, lanes);
        Lanes bound, sum = {};
        bound_node(lanes, tree, tree.root.index(), GeometryClamp::none(), bound);
        sum_below(lanes, tree, tree.root, GeometryClamp::none(), sum);
        // [BT709, 3.3]: Cb is the rest of blue over 1.8556; half of it counts.
        const float blue = core::luminance_weights.z, noticed = 0.5f * (1.0f / blue - 1.0f) / 1.8556f;
        for (int i = 0; i < lane_count; ++i)
            EXPECT_GE(bound[i] * 1.0005f + 1e-7f, noticed * sum[i]) << seed << " " << i;
    }
}

TEST(LightKernel, AgreesWithTheBsdfAndTheInverseSquareLaw) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const auto points = points_at_random(seed, true);
        GatherLanes lanes;
        fill_from(points, lanes);
        LightPoint lamp = lights_at_random(LightType::oriented, 1, seed + 9000).front();
        const LightPoint one[] = {lamp};
        const LightTree tree = build_light_tree(LightType::oriented, one, 1);
        LightLanes unit;
        evaluate_light(lanes, LightType::oriented, tree.lights.front(), nullptr, GeometryClamp::none(), unit);
        ASSERT_LT(glm::length(tree.lights.front().normal() - lamp.normal), 1e-4f);
        lamp.normal = tree.lights.front().normal();
        Lanes luminance = {};
        add_luminance(lanes, unit_light(lanes, unit), lamp.intensity, luminance);
        for (int i = 0; i < lane_count; ++i) {
            const SurfacePoint& p = points[static_cast<std::size_t>(i)].point;
            const glm::dvec3 d = glm::dvec3(lamp.position) - glm::dvec3(p.position);
            const double d2 = glm::dot(d, d);
            const glm::vec3 l = glm::vec3(d / std::sqrt(d2));
            const double g =
                std::max(0.0f, glm::dot(l, p.shading_normal)) * std::max(0.0f, -glm::dot(l, lamp.normal)) / d2;
            const double vh = std::sqrt(std::max(0.0f, 0.5f * (1 + glm::dot(l, p.outgoing))));
            const double passes = p.bsdf.has_glossy() ? 1 - std::pow(1 - vh, 5.0) : 1.0;
            EXPECT_NEAR(unit.diffuse[i], g * passes, 1e-4 * g + 1e-7);
            const glm::vec3 f = evaluate(p.bsdf, p.shading_normal, p.outgoing, l);
            const double expected =
                core::luminance(points[static_cast<std::size_t>(i)].weight * f * lamp.intensity) * g;
            // Sharp lobes lose digits at their peak: alpha 0.01 divides rounding errors by 1e-4.
            EXPECT_NEAR(luminance[i], expected, (p.bsdf.alpha < 0.05f ? 2e-2 : 1e-3) * expected + 1e-6);
        }
    }
}

/// Diffuse parts by Disney's and by Oren and Nayar's formulas, under lobes that cover them or not.
std::vector<GatherPoint> shaped_points(std::uint64_t seed) {
    auto points = points_at_random(seed, true);
    for (std::size_t i = 0; i < points.size(); ++i) {
        Bsdf& bsdf = points[i].point.bsdf;
        const float roughness = kernel_dice(seed, i, 20);
        if (i % 3 != 2) bsdf.shape = i % 3 == 0 ? DiffuseShape::disney(roughness) : DiffuseShape::oren_nayar(roughness);
        bsdf.covered = i % 4 == 0 ? 0.0f : 1.0f;
    }
    return points;
}

TEST(LightKernel, AgreesWithTheBsdfOfShapedDiffuseParts) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const auto points = shaped_points(seed);
        GatherLanes lanes;
        fill_from(points, lanes);
        LightPoint lamp = lights_at_random(LightType::oriented, 1, seed + 9000).front();
        const LightPoint one[] = {lamp};
        const LightTree tree = build_light_tree(LightType::oriented, one, 1);
        lamp.normal = tree.lights.front().normal();
        LightLanes unit;
        evaluate_light(lanes, LightType::oriented, tree.lights.front(), nullptr, GeometryClamp::none(), unit);
        Lanes luminance = {};
        add_luminance(lanes, unit_light(lanes, unit), lamp.intensity, luminance);
        for (int i = 0; i < lane_count; ++i) {
            const GatherPoint& point = points[static_cast<std::size_t>(i)];
            const SurfacePoint& p = point.point;
            const glm::dvec3 d = glm::dvec3(lamp.position) - glm::dvec3(p.position);
            const auto l = glm::vec3(glm::normalize(d));
            const double g = std::max(0.0f, glm::dot(l, p.shading_normal)) * std::max(0.0f, -glm::dot(l, lamp.normal)) /
                             glm::dot(d, d);
            const glm::vec3 f = evaluate(p.bsdf, p.shading_normal, p.outgoing, l);
            const double expected = core::luminance(point.weight * f * lamp.intensity) * g;
            EXPECT_NEAR(luminance[i], expected, (p.bsdf.alpha < 0.05f ? 2e-2 : 2e-3) * expected + 1e-6) << seed << i;
        }
    }
}

TEST(NodeBound, IsNoLessThanTheLightOnShapedDiffuseParts) {
    for (const LightType type : {LightType::oriented, LightType::punctual, LightType::directional}) {
        double log_slack = 0;
        int compared = 0;
        for (std::uint64_t seed = 0; seed < 100; ++seed) {
            const std::vector<LightPoint> lights = lights_at_random(type, 12, seed);
            const LightTree tree = build_light_tree(type, lights, seed);
            auto points = shaped_points(seed + 7000);
            for (GatherPoint& p : points) p.point.bsdf.f0 = p.point.bsdf.f90 = glm::vec3(0);  // diffuse parts alone
            GatherLanes lanes;
            fill_from(points, lanes);
            Lanes bound, sum = {};
            bound_node(lanes, tree, tree.root.index(), GeometryClamp::none(), bound);
            sum_below(lanes, tree, tree.root, GeometryClamp::none(), sum);
            for (int i = 0; i < lane_count; ++i) {
                EXPECT_GE(bound[i] * 1.0005f + 1e-7f, sum[i]) << seed << " " << i;
                if (!(sum[i] > 1e-3f)) continue;
                log_slack += std::log(static_cast<double>(bound[i]) / sum[i]);
                ++compared;
            }
        }
        ASSERT_GT(compared, 50);
        EXPECT_LT(std::exp(log_slack / compared), 6.0) << "as slack as bounds of Lambert's about";
    }
}

TEST(LightKernel, ClampsGeometryAtTheDiscOfTheLight) {
    std::vector<GatherPoint> points = points_at_random(1, false);
    points.resize(1);
    points[0].point.position = {0, 0, 0};
    points[0].point.geometric_normal = points[0].point.shading_normal = {0, 0, 1};
    GatherLanes lanes;
    fill_from(points, lanes);
    TreeLight light;
    light.axis = core::PackedNormal({0, 0, -1});
    light.disc2 = 0.04f;
    light.intensity = glm::vec3(1);
    const GeometryClamp clamp{0.25f};  // a clamping distance of 0.2 / 0.5
    LightLanes unit;
    for (const float z : {1e-20f, 1e-3f, 0.1f, 0.39f}) {
        light.position = {0, 0, z};
        evaluate_light(lanes, LightType::oriented, light, nullptr, clamp, unit);
        EXPECT_TRUE(unit.any_clamped);
        EXPECT_NEAR(unit.diffuse[0], 1 / 0.16f, 1e-4f);
    }
    light.position = {0, 0, 0.41f};
    evaluate_light(lanes, LightType::oriented, light, nullptr, clamp, unit);
    EXPECT_FALSE(unit.any_clamped);
    EXPECT_NEAR(unit.diffuse[0], 1 / (0.41f * 0.41f), 1e-4f);
    // At the point itself, and behind it, there is nothing.
    for (const float z : {0.0f, -0.1f}) {
        light.position = {0, 0, z};
        evaluate_light(lanes, LightType::oriented, light, nullptr, clamp, unit);
        EXPECT_EQ(unit.diffuse[0], 0.0f);
    }
}

TEST(LightKernel, LeavesUnusedLanesDark) {
    std::vector<GatherPoint> points = points_at_random(2, true);
    points.resize(3);
    GatherLanes lanes;
    fill_from(points, lanes);
    for (const LightType type : types) {
        const LightTree tree = build_light_tree(type, lights_at_random(type, 6, 3), 1);
        LightLanes unit;
        Lanes bound;
        for (std::uint32_t i = 0; i < tree.lights.size(); ++i) {
            evaluate_light(lanes, type, tree.lights[i], tree.spot(i), GeometryClamp{}, unit);
            for (int lane = 3; lane < lane_count; ++lane) EXPECT_EQ(unit.diffuse[lane], 0.0f);
        }
        for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
            bound_node(lanes, tree, n, GeometryClamp{}, bound);
            for (int i = 3; i < lane_count; ++i) EXPECT_EQ(bound[i], 0.0f);
        }
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
