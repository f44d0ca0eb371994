#include "renderer/cut/light_slopes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/sampling.h"
#include "renderer/cut/cut.h"
#include "tests/renderer/lighting.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

constexpr LightFamily families[] = {LightFamily::oriented, LightFamily::punctual, LightFamily::directional};

glm::vec3 at(const Vec3Lanes& v, int i) {
    return {v.x[i], v.y[i], v.z[i]};
}

TreeLight light_of(LightFamily family) {
    TreeLight l;
    l.position = {0.4f, 2.0f, -0.3f};
    if (family == LightFamily::directional) l.position = glm::normalize(l.position);
    l.axis = core::PackedNormal(glm::normalize(glm::vec3(-0.3f, -1, 0.2f)));
    l.disc2 = family == LightFamily::punctual ? std::numeric_limits<float>::infinity() : 1e-8f;
    return l;
}

/// Points below the light; the k-th is the first one displaced by `step` and with its normal turned.
void fill_about(glm::vec3 step, glm::vec3 turn, GatherLanes& lanes) {
    GatherPoint p;
    p.point.position = glm::vec3(0.1f, 0, 0.2f) + step;
    p.point.geometric_normal = {0, 1, 0};
    p.point.shading_normal = glm::vec3(0.28f, 0.96f, 0) + turn;
    p.point.outgoing = {0, 1, 0};
    const GatherPoint* const points[] = {&p};
    fill(lanes, points);
}

Vec3Lanes all_seen() {
    Vec3Lanes visible;
    for (int i = 0; i < lane_count; ++i) visible.x[i] = visible.y[i] = visible.z[i] = 1.0f;
    return visible;
}

float irradiance(LightFamily family, glm::vec3 step, glm::vec3 turn) {
    GatherLanes lanes;
    fill_about(step, turn, lanes);
    LightLanes unit;
    evaluate_light(lanes, family, light_of(family), nullptr, GeometryClamp::none(), unit);
    return unit.diffuse[0];
}

TEST(LightSlopes, AreWhatIrradianceChangesByOverASmallStep) {
    for (const LightFamily family : families) {
        GatherLanes lanes;
        fill_about({}, {}, lanes);
        SlopeLanes slopes{};
        const TreeLight light = light_of(family);
        add_slopes(lanes, family, {&light, nullptr, {1, 2, 0}}, GeometryClamp::none(), all_seen(), slopes);
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 step(0);
            step[axis] = 0.01f;
            const float by_place = (irradiance(family, step, {}) - irradiance(family, -step, {})) / 0.02f;
            const float by_normal = (irradiance(family, {}, step) - irradiance(family, {}, -step)) / 0.02f;
            EXPECT_NEAR(at(slopes.by_place[0], 0)[axis], by_place, 2e-4f);
            EXPECT_NEAR(at(slopes.by_normal[0], 0)[axis], by_normal, 2e-4f);
            EXPECT_EQ(at(slopes.by_place[1], 0)[axis], 2.0f * at(slopes.by_place[0], 0)[axis]);
            EXPECT_EQ(at(slopes.by_normal[2], 0)[axis], 0.0f);
        }
    }
}

TEST(LightSlopes, OfALightOnASurfaceAreItsDiscs) {
    // Nearly as wide as it is far: G = cos cos / (d^2 + r^2).
    TreeLight light = light_of(LightFamily::oriented);
    light.disc2 = 3.0f;
    const auto geometry = [&](glm::vec3 step, glm::vec3 turn) {
        const glm::vec3 q = light.position - glm::vec3(0.1f, 0, 0.2f) - step;
        const float d2 = glm::dot(q, q);
        return glm::dot(glm::vec3(0.28f, 0.96f, 0) + turn, q) * -glm::dot(light.axis.unpack(), q) / d2 /
               (d2 + light.disc2);
    };
    GatherLanes lanes;
    fill_about({}, {}, lanes);
    SlopeLanes slopes{};
    add_slopes(lanes, LightFamily::oriented, {&light, nullptr, {1, 1, 1}}, GeometryClamp::none(), all_seen(), slopes);
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 step(0);
        step[axis] = 0.01f;
        EXPECT_NEAR(at(slopes.by_place[0], 0)[axis], (geometry(step, {}) - geometry(-step, {})) / 0.02f, 2e-4f);
        EXPECT_NEAR(at(slopes.by_normal[0], 0)[axis], (geometry({}, step) - geometry({}, -step)) / 0.02f, 2e-4f);
    }
}

TEST(LightSlopes, TakeALampsRangeAndConeForConstant) {
    TreeLight light = light_of(LightFamily::punctual);
    GatherLanes lanes;
    fill_about({}, {}, lanes);
    SlopeLanes bare{}, shaded{};
    LightLanes all, some;
    evaluate_light(lanes, LightFamily::punctual, light, nullptr, GeometryClamp::none(), all);
    add_slopes(lanes, LightFamily::punctual, {&light, nullptr, {1, 1, 1}}, GeometryClamp::none(), all_seen(), bare);
    light.disc2 = 9.0f;
    const Spot spot{0.5f, 0.2f};
    evaluate_light(lanes, LightFamily::punctual, light, &spot, GeometryClamp::none(), some);
    add_slopes(lanes, LightFamily::punctual, {&light, &spot, {1, 1, 1}}, GeometryClamp::none(), all_seen(), shaded);
    const float factor = some.diffuse[0] / all.diffuse[0];
    ASSERT_GT(factor, 0.05f);
    ASSERT_LT(factor, 0.8f);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(at(shaded.by_place[0], 0)[axis], factor * at(bare.by_place[0], 0)[axis], 1e-5f);
        EXPECT_NEAR(at(shaded.by_normal[0], 0)[axis], factor * at(bare.by_normal[0], 0)[axis], 1e-5f);
    }
}

TEST(LightSlopes, AreNoneOfWhatIsHiddenOrClamped) {
    GatherLanes lanes;
    fill_about({}, {}, lanes);
    TreeLight light = light_of(LightFamily::oriented);
    const Vec3Lanes nothing{};
    SlopeLanes slopes{};
    add_slopes(lanes, LightFamily::oriented, {&light, nullptr, {1, 1, 1}}, GeometryClamp::none(), nothing, slopes);
    EXPECT_EQ(at(slopes.by_place[0], 0), glm::vec3(0));
    EXPECT_EQ(at(slopes.by_normal[0], 0), glm::vec3(0));
    light.disc2 = 100.0f;  // G is at most a hundredth of the scale
    add_slopes(lanes, LightFamily::oriented, {&light, nullptr, {1, 1, 1}}, GeometryClamp{0.25f}, all_seen(), slopes);
    EXPECT_EQ(at(slopes.by_place[0], 0), glm::vec3(0));
}

TEST(LightSlopes, OfACutTellWhatItsLightIsNearby) {
    test::SceneBuilder b;
    b.add_quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, b.add_material());
    b.add_quad({-0.5f, 1.2f, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter(glm::vec3(3, 2, 1)));
    b.add_camera({0, 1, 3}, {0, 0, 0});
    test::LitStage stage(b);
    const LightForest forest = stage.light({});
    const auto floor_at = [&](float u) { return stage.point_at(0, 0, {u, 0.3f}, {0, 1, 0}); };
    const GatherPoint here = floor_at(0.3f), there = floor_at(0.33f);
    const GatherPoint* const points[] = {&here};
    GatherLanes lanes;
    fill(lanes, points);
    GroupTolerance tolerance;
    for (int i = 0; i < lane_count; ++i) tolerance.set(i, {{0.0f, 0.002f}, 0.0f});
    Gatherer gatherer(forest, stage.scenery().tracer());
    GatheredLight light;
    gatherer.gather(lanes, tolerance, {}, light);
    SlopeLanes slopes;
    gatherer.slopes(lanes, slopes);

    const glm::vec3 step = there.point.position - here.point.position;
    ASSERT_GT(glm::length(step), 0.05f);
    const float now = light.direct.at(0).x, foretold = now + glm::dot(at(slopes.by_place[0], 0), step);
    const GatherPoint* const others[] = {&there};
    fill(lanes, others);
    gatherer.gather_all(lanes, light);
    const float truth = light.direct.at(0).x;
    EXPECT_GT(std::abs(truth - now), 0.03f * truth);
    EXPECT_LT(std::abs(truth - foretold), 0.2f * std::abs(truth - now));
}

}  // namespace
}  // namespace render2mpeg::renderer
