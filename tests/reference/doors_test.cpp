// Light that a door lets through, against a path tracer.
#include <gtest/gtest.h>

#include "core/color.h"
#include "tests/reference/path_tracer.h"
#include "tests/renderer/door_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

constexpr int bounces = 4;

/// Places of the far room: two on its floor, one on each of two walls, one on the ceiling; seen from its middle.
const glm::vec3 places[] = {{5.5f, 0, 2}, {7, 0, 3.2f}, {8, 1.2f, 2}, {6, 1, 0}, {6, 3, 2.5f}};

SurfacePoint surface(const PosedScene& posed_scene, glm::vec3 place) {
    const glm::vec3 eye{6, 1.5f, 2}, way = glm::normalize(place - eye);
    const Hit hit = posed_scene.tracer().nearest(eye, way, 100.0f);
    return posed_scene.surface_at(hit.address, -way);
}

/// Indirect light that the virtual lights make it scatter.
double by_points(const PosedScene& posed_scene, const std::vector<LightPoint>& lit, const SurfacePoint& point) {
    LightTrees light_trees = test::build_light_trees({}, lit, 1);
    light_trees.point_clamp = {0.25f};
    GatherPoint gathering;
    gathering.point = point;
    const GatherPoint* const points[] = {&gathering};
    GatherLanes lanes;
    fill(lanes, points);
    GatheredLight light;
    Gatherer(light_trees, posed_scene.tracer()).gather_all(lanes, light);
    return core::luminance(point_light(light, 0, gathering).scattered(gathering));
}

TEST(DoorsSlow, LightTheNextRoomAsPathsDo) {
    test::VirtualLightStage stage(test::rooms_with_a_door(), {32768, bounces});
    double open = 0;
    for (const double seconds : {2.0, 1.6, 1.3, 0.5}) {
        stage.pose(seconds);
        const std::vector<LightPoint> lit = stage.light();
        double points = 0, paths = 0;
        for (const glm::vec3& place : places) {
            const SurfacePoint point = surface(stage.posed_scene(), place);
            const double found = by_points(stage.posed_scene(), lit, point);
            const reference::Estimate e = reference::scattered_light(stage.posed_scene(), point, bounces, 30000, 1, 1);
            const double truth = core::luminance(glm::vec3(e.mean)), error = core::luminance(glm::vec3(e.error));
            points += found;
            paths += truth;
            EXPECT_NEAR(found, truth, 0.2 * truth + 4 * error + 1e-3 * open) << seconds << " s, x = " << place.x;
        }
        if (open == 0) open = points;
        EXPECT_NEAR(points, paths, 0.1 * paths + 1e-4 * open) << seconds << " s";
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
