#include "renderer/cut/dynamic_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/sampling.h"
#include "renderer/cut/cut.h"
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

bool within(const MiddleBox& box, glm::vec3 p) {
    const glm::vec3 d = glm::abs(p - box.middle);
    return d.x < box.half.x && d.y < box.half.y && d.z < box.half.z;
}

/// By a thousand steps along it.
bool walks_through(const MiddleBox& box, glm::vec3 from, glm::vec3 to) {
    if (within(box, from) || within(box, to)) return false;
    for (int k = 1; k < 1000; ++k)
        if (within(box, from + 0.001f * static_cast<float>(k) * (to - from))) return true;
    return false;
}

TEST(GroupDynamicObjects, KnowWhichWaysLeadThroughABox) {
    int through = 0, wrong = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const GatherLanes lanes = group_at(some_place(i, 0));
        const MiddleBox box{some_place(i, 1), glm::vec3(0.2f, 0.5f, 0.3f)};
        const glm::vec3 light = some_place(i, 2);
        GroupDynamicObjects movers;
        movers.choose(lanes, {&box, 1});
        ASSERT_FALSE(movers.empty());
        const std::uint32_t passed = movers.passed(rays_to(lanes, light));
        for (int k = 0; k < lane_count; ++k) {
            const bool walked = walks_through(box, {lanes.origin.x[k], lanes.origin.y[k], lanes.origin.z[k]}, light);
            through += walked ? 1 : 0;
            wrong += walked != ((passed >> k & 1u) != 0) ? 1 : 0;
        }
        // What a ray passes the rough look does not leave out.
        if (passed != 0) {
            EXPECT_TRUE(movers.may_hide(LightType::oriented, light, glm::vec3(0))) << i;
        }
    }
    EXPECT_GT(through, 200);
    EXPECT_LE(wrong, through / 20);  // steps may miss an edge
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
        GroupDynamicObjects movers;
        movers.choose(lanes, {&box, 1}, 0.0f);
        std::uint32_t rays = 0;
        for (std::uint64_t l = 0; l < 20; ++l) {
            const glm::vec3 at = 0.25f * some_place(20 * i + l, 3);
            rays |= movers.met(rays_to(lanes, middle + (2.0f * at - 1.0f) * half));
        }
        const bool can = movers.can_hide(LightType::oriented, middle, half);
        if (rays != 0) {
            EXPECT_TRUE(can) << i;
            ++met;
        }
        left_out += can ? 0 : 1;
    }
    EXPECT_GT(met, 150);
    EXPECT_GT(left_out, 400);
}

TEST(GroupDynamicObjects, LeaveOutWhatIsBehindAndFarAside) {
    const GatherLanes lanes = group_at(glm::vec3(0));
    const MiddleBox box{{0, 2, 0}, glm::vec3(0.3f)};
    GroupDynamicObjects movers;
    movers.choose(lanes, {&box, 1});
    EXPECT_TRUE(movers.may_hide(LightType::oriented, {0, 4, 0}, glm::vec3(0.1f)));
    EXPECT_TRUE(movers.may_hide(LightType::directional, {0, 1, 0}, glm::vec3(0.01f)));
    EXPECT_FALSE(movers.may_hide(LightType::oriented, {0, 1, 0}, glm::vec3(0.1f)));
    EXPECT_FALSE(movers.may_hide(LightType::oriented, {4, 1, 0}, glm::vec3(0.1f)));
    EXPECT_FALSE(movers.may_hide(LightType::directional, {0, -1, 0}, glm::vec3(0.01f)));
}

TEST(GroupDynamicObjects, TakeTheLargestOfManyAndNoneThatAreTiny) {
    const GatherLanes lanes = group_at(glm::vec3(0));
    std::vector<MiddleBox> boxes(100, {{0, 50, 0}, glm::vec3(0.1f)});
    GroupDynamicObjects movers;
    movers.choose(lanes, boxes);
    EXPECT_TRUE(movers.empty());
    for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = {{3, 2, 0}, glm::vec3(0.1f)};
    boxes.back() = {{0, 2, 0}, glm::vec3(0.5f)};
    movers.choose(lanes, boxes);
    EXPECT_EQ(movers.passed(rays_to(lanes, {0, 4, 0})), 0xffffu);
}

TEST(GroupDynamicObjects, OfATracerAreBoxesAboutWhatMovesAndIsThere) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {4, 3, 5}, b.add_material(), true);
    const int ball = b.add_sphere({0, 0, 0}, 0.4f, b.add_material(), 12);
    b.move_object(ball, {{1, 1, 1}, {3, 1, 2}});
    for (const int second : {0, 1}) {
        const LitStage stage(b, second);
        const auto movers = stage.posed_scene().tracer().dynamic_objects();
        ASSERT_EQ(movers.size(), 1u);
        const glm::vec3 middle = second == 0 ? glm::vec3(1) : glm::vec3(3, 1, 2);
        EXPECT_LT(glm::distance(movers[0].middle, middle), 0.02f);
        EXPECT_LT(glm::distance(movers[0].half, glm::vec3(0.4f)), 0.04f);
    }
    SceneBuilder still;
    still.add_box({0, 0, 0}, {4, 3, 5}, still.add_material(), true);
    EXPECT_TRUE(LitStage(still).posed_scene().tracer().dynamic_objects().empty());
}

/// A shining ceiling over a floor, and a board between, which moves or does not.
SceneBuilder under_a_board(bool moves) {
    SceneBuilder b;
    b.add_quad({0, 0, 4}, {4, 0, 0}, {0, 0, -4}, b.add_material());
    b.add_quad({0, 3, 0}, {4, 0, 0}, {0, 0, 4}, b.add_emitter(glm::vec3(2)));
    const int board = b.add_box({-1, -0.01f, -1}, {1, 0.01f, 1}, b.add_material());
    b.move_object(board, {{2, 1, 2}, moves ? glm::vec3(2, 1.2f, 2) : glm::vec3(2, 1, 2)});
    return b;
}

/// Root mean square error of coarse cuts all over the floor, as a share of the light.
double error_of_cuts(bool moves) {
    LitStage stage(under_a_board(moves));
    EXPECT_EQ(stage.posed_scene().tracer().dynamic_objects().size(), moves ? 1u : 0u);
    const LightTrees light_trees = stage.light({1024, 0, 1, 0, GeometryClamp::none()});
    Gatherer gatherer(light_trees, stage.posed_scene().tracer());
    double squares = 0, lit = 0;
    for (int g = 0; g < 400; ++g) {
        std::vector<GatherPoint> points(lane_count);
        const GatherPoint* pointers[lane_count];
        for (int i = 0; i < lane_count; ++i) {
            const glm::vec2 uv(0.05f + 0.045f * static_cast<float>(g % 20) + 0.005f * static_cast<float>(i % 4),
                               0.05f + 0.045f * static_cast<float>(g / 20) + 0.005f * static_cast<float>(i / 4));
            const Hit hit = stage.posed_scene().tracer().nearest({4 * uv.x, 0.1f, 4 * uv.y}, {0, -1, 0}, 1.0f);
            points[static_cast<std::size_t>(i)].point = stage.posed_scene().surface_at(hit.address, {0, 1, 0});
            pointers[i] = &points[static_cast<std::size_t>(i)];
        }
        GatherLanes lanes;
        fill(lanes, pointers);
        lanes.set = g % 4;
        GroupTolerance tolerance{};
        std::fill(std::begin(tolerance.relative), std::end(tolerance.relative), 0.1f);
        GatheredLight cut, all;
        gatherer.gather(lanes, tolerance, {8, 4000, Stop::honest}, cut);
        gatherer.gather_all(lanes, all);
        for (int i = 0; i < lane_count; ++i) {
            if (!(all.direct.at(i).y > 0)) continue;
            const double error = cut.direct.at(i).y / all.direct.at(i).y - 1;
            squares += error * error;
            lit += 1;
        }
    }
    EXPECT_GT(lit, 5000);
    return std::sqrt(squares / lit);
}

TEST(Movers, HidePartsOfClustersOneByOne) {
    // The same light and shadow, where rays to representatives are all that is asked, and where what moves is asked
    // for part by part.
    const double still = error_of_cuts(false), moving = error_of_cuts(true);
    EXPECT_GT(still, 0.005);
    EXPECT_LT(moving, 0.8 * still) << moving << " of " << still;
}

}  // namespace
}  // namespace render2mpeg::renderer
