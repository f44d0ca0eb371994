#include "renderer/cut/dynamic_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/sampling.h"
#include "renderer/cut/gatherer.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

/// Sixteen lanes within 10 cm of a place.
GatherLanes group_at(glm::vec3 place) {
    GatherLanes lanes{};
    lanes.count = lane_count;
    for (int i = 0; i < lane_count; ++i) {
        lanes.origin.x[i] = place.x + 0.1f * static_cast<float>(i % 4) / 3;
        lanes.origin.y[i] = place.y;
        lanes.origin.z[i] = place.z + 0.1f * static_cast<float>(i / 4) / 3;
    }
    return lanes;
}

ShadowPacket rays_to(const GatherLanes& lanes, glm::vec3 light) {
    ShadowPacket packet;
    for (int i = 0; i < lane_count; ++i) {
        packet.origin_x[i] = lanes.origin.x[i];
        packet.origin_y[i] = lanes.origin.y[i];
        packet.origin_z[i] = lanes.origin.z[i];
        packet.direction_x[i] = light.x - lanes.origin.x[i];
        packet.direction_y[i] = light.y - lanes.origin.y[i];
        packet.direction_z[i] = light.z - lanes.origin.z[i];
        packet.far[i] = 1.0f;
    }
    return packet;
}

glm::vec3 some_place(std::uint64_t i, std::uint64_t which) {
    return 4.0f * glm::vec3(core::uniform(1, i, 3 * which), core::uniform(1, i, 3 * which + 1),
                            core::uniform(1, i, 3 * which + 2));
}

TEST(GroupDynamicObjects, SayThatTheyCannotHideOnlyWhereNoRayMeetsThem) {
    int met = 0, left_out = 0;
    for (std::uint64_t i = 0; i < 4000; ++i) {
        GatherLanes lanes = group_at(some_place(i, 0));
        // Lanes far apart, clusters larger than their distance, boxes that hold either end.
        const float apart = 2.0f * core::uniform(2, i, 0), wide = 3.0f * core::uniform(2, i, 1);
        for (int k = 0; k < lane_count; ++k)
            lanes.origin.x[k] += apart * core::uniform(3, i, static_cast<std::uint64_t>(k));
        const MiddleBox box{some_place(i, 1), glm::vec3(0.2f, 0.5f, 0.3f) * core::uniform(2, i, 2)};
        const glm::vec3 middle = some_place(i, 2), half = wide * glm::vec3(0.5f, 0.2f, 0.3f);
        GroupDynamicObjects dynamic_objects;
        dynamic_objects.choose(lanes, {&box, 1});
        std::uint32_t rays = 0;
        for (std::uint64_t l = 0; l < 20; ++l) {
            const glm::vec3 at = 0.25f * some_place(20 * i + l, 3);
            rays |= dynamic_objects.met(rays_to(lanes, middle + (2.0f * at - 1.0f) * half));
        }
        const bool can = dynamic_objects.can_hide(LightType::oriented, middle, half);
        if (rays != 0) {
            EXPECT_TRUE(can) << i;
            ++met;
        }
        left_out += can ? 0 : 1;
    }
    EXPECT_GT(met, 150);
    EXPECT_GT(left_out, 400);
}

TEST(GroupDynamicObjects, TakeTheLargestOfMany) {
    const GatherLanes lanes = group_at(glm::vec3(0));
    std::vector<MiddleBox> boxes(100, {{3, 2, 0}, glm::vec3(0.1f)});
    boxes.back() = {{0, 2, 0}, glm::vec3(0.5f)};
    GroupDynamicObjects dynamic_objects;
    EXPECT_TRUE(dynamic_objects.empty());
    dynamic_objects.choose(lanes, boxes);
    EXPECT_FALSE(dynamic_objects.empty());
    EXPECT_EQ(dynamic_objects.met(rays_to(lanes, {0, 4, 0})), 0xffffu);
}

TEST(GroupDynamicObjects, OfATracerAreBoxesAboutWhatMovesAndIsThere) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 3, 5}, b.add_material(), true);
    const int ball = b.add_sphere({0, 0, 0}, 0.4f, b.add_material(), 12);
    b.move_object(ball, {{1, 1, 1}, {3, 1, 2}});
    for (const int second : {0, 1}) {
        const LitStage stage(b, second);
        const auto dynamic_objects = stage.posed_scene().tracer().dynamic_objects();
        ASSERT_EQ(dynamic_objects.size(), 1u);
        const glm::vec3 middle = second == 0 ? glm::vec3(1) : glm::vec3(3, 1, 2);
        EXPECT_LT(glm::distance(dynamic_objects[0].middle, middle), 0.02f);
        EXPECT_LT(glm::distance(dynamic_objects[0].half, glm::vec3(0.4f)), 0.04f);
    }
    SceneBuilder still;
    still.add_box({0, 0, 0}, {4, 3, 5}, still.add_material(), true);
    EXPECT_TRUE(LitStage(still).posed_scene().tracer().dynamic_objects().empty());
}

}  // namespace
}  // namespace render2mpeg::renderer
