#include "renderer/cut/bias_compensation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/sampling.h"
#include "tests/renderer/lighting.h"
#include "tests/renderer/virtual_light_stage.h"

namespace render2mpeg::renderer {
namespace {

/// One lane at a place with a normal.
GatherLanes lane_at(glm::vec3 position, glm::vec3 normal) {
    static GatherPoint point;
    point.point.position = position;
    point.point.geometric_normal = point.point.shading_normal = point.point.outgoing = normal;
    point.point.bsdf.diffuse = glm::vec3(0.5f);
    const GatherPoint* const points[] = {&point};
    GatherLanes lanes;
    fill(lanes, points);
    return lanes;
}

DiscLight first_of(const GatherLanes& lanes, const TreeLight& light) {
    return disc_light(lanes, 1, light)[0];
}

TreeLight disc(glm::vec3 position, float radius) {
    TreeLight light;
    light.position = position;
    light.axis = core::PackedNormal({0, 1, 0});
    light.disc2 = radius * radius;
    light.intensity = glm::vec3(1);
    return light;
}

/// Mean of G over the part of the hexagon that lies before the surface, by a fine lattice.
double by_lattice(glm::vec3 at, glm::vec3 normal, const TreeLight& light) {
    glm::vec3 tangent, bitangent;
    core::make_frame(light.normal(), tangent, bitangent);
    const double out = 1.75 * 1.0996361 * std::sqrt(light.disc2), inner = out * std::sqrt(0.75);
    double sum = 0, count = 0;
    for (int i = -400; i <= 400; ++i)
        for (int k = -400; k <= 400; ++k) {
            const double u = out * i / 400, v = out * k / 400;
            // The regular hexagon with corners along u.
            if (std::abs(v) > inner || std::abs(u) * std::sqrt(3.0) + std::abs(v) > 2 * inner) continue;
            const glm::vec3 way =
                light.position + static_cast<float>(u) * tangent + static_cast<float>(v) * bitangent - at;
            const double height = glm::dot(way, normal), d2 = glm::dot(way, way);
            if (height <= 0) continue;
            sum += height * std::max(0.0f, -glm::dot(way, light.normal())) / (d2 * d2);
            count += 1;
        }
    return sum / count;
}

TEST(NearLights, SendWhatAllPlacesOfTheirDiscsSend) {
    const TreeLight light = disc({0.3f, 0, -0.2f}, 0.8f);
    const glm::vec3 normals[] = {
        {0, -1, 0}, glm::normalize(glm::vec3{0.1f, -1, 0.2f}), {1, 0, 0}, glm::normalize(glm::vec3{0.7f, -0.5f, 0.5f})};
    for (const glm::vec3 normal : normals)
        for (const glm::vec3 at : {glm::vec3{0.2f, 0.9f, 0.3f}, {-0.6f, 0.3f, -0.4f}, {0.1f, 0.1f, 0.2f}}) {
            const double truth = by_lattice(at, normal, light);
            EXPECT_NEAR(first_of(lane_at(at, normal), light).irradiance / truth, 1.0, 0.01) << at.y;
        }
}

TEST(NearLights, FillTheViewOfAPointThatTouchesThem) {
    // Irradiance pi L = I / r^2 by a disc that fills the view; the hexagon is wider and as much dimmer.
    const float r = 0.5f;
    const DiscLight found = first_of(lane_at({0.1f, 1e-4f, 0}, {0, -1, 0}), disc({0, 0, 0}, r));
    EXPECT_EQ(found.share, 1.0f);
    EXPECT_NEAR(found.irradiance * r * r * 1.75f * 1.75f, 1.0f, 1e-3f);
}

TEST(NearLights, LoseNothingBehindTheSurfaceThatIsLit) {
    // A point at an edge sees half of the disc, which lights as the whole would: what lies beyond the edge is none.
    const DiscLight edge = first_of(lane_at({0, 0.01f, 0}, {1, 0, 0}), disc({0.001f, 0, 0}, 0.5f));
    const DiscLight inside = first_of(lane_at({0, 0.01f, 0}, {1, 0, 0}), disc({0.3f, 0, 0}, 0.5f));
    EXPECT_GT(edge.irradiance, inside.irradiance);
    EXPECT_LT(edge.irradiance, 2.0f * inside.irradiance);
}

TEST(NearLights, ArePointsFromThreeRadiiOn) {
    const GatherLanes lanes = lane_at({0, 1, 0}, {0, -1, 0});
    EXPECT_EQ(first_of(lanes, disc({0, 0, 0}, 0.33f)).share, 0.0f);
    EXPECT_NEAR(first_of(lanes, disc({0, 0, 0}, 0.4f)).share, 0.5f, 1e-4f);
    EXPECT_EQ(first_of(lanes, disc({0, 0, 0}, 0.51f)).share, 1.0f);
}

/// A closed room whose walls all shine alike: indirect light is the same everywhere.
class FurnaceEdges : public testing::Test {
  protected:
    FurnaceEdges() {
        for (std::uint64_t seed = 1; seed <= draws; ++seed) {
            stages_.push_back(
                std::make_unique<test::VirtualLightStage>(room(), renderer::VirtualLightSettings{25600, 3}, 64, seed));
            light_trees_.push_back(test::build_light_trees({}, stages_.back()->light(), 1));
        }
    }
    static test::SceneBuilder room() {
        test::SceneBuilder b;
        const int wall = b.add_material(glm::vec3(0.5f));
        b.material(wall).emission = glm::vec3(1);
        b.add_box({0, 0, 0}, {4, 4, 4}, wall, true);
        return b;
    }
    /// Mean and scatter of indirect irradiance along a line of the floor at a distance from a wall, without clamp or
    /// with; means over all draws of the light points, of which one may happen to lie near.
    std::pair<double, double> along(float from_wall, GeometryClamp clamp) {
        std::pair<double, double> all;
        for (std::size_t i = 0; i < draws; ++i) {
            const auto [mean, scatter] = along(*stages_[i], light_trees_[i], from_wall, clamp);
            all.first += mean / draws;
            all.second += scatter / draws;
        }
        return all;
    }
    static std::pair<double, double> along(test::VirtualLightStage& stage, LightTrees& light_trees, float from_wall,
                                           GeometryClamp clamp) {
        light_trees.point_clamp = clamp;
        Gatherer gatherer(light_trees, stage.posed_scene().tracer());
        double sum = 0, squares = 0;
        for (int i = 0; i < places; ++i) {
            const float z = 0.5f + 3.0f * (static_cast<float>(i) + 0.5f) / places;
            const Hit hit = stage.posed_scene().tracer().nearest({from_wall, 1, z}, {0, -1, 0}, 10);
            GatherPoint point;
            point.point = stage.posed_scene().surface_at(hit.address, {0, 1, 0});
            const GatherPoint* const points[] = {&point};
            GatherLanes lanes;
            fill(lanes, points);
            GatheredLight light;
            gatherer.gather_all(lanes, light);
            sum += light.indirect.r[0] / places;
            squares += static_cast<double>(light.indirect.r[0]) * light.indirect.r[0] / places;
        }
        return {sum, std::sqrt(std::max(0.0, squares - sum * sum)) / sum};
    }

    static constexpr int places = 48;
    static constexpr std::size_t draws = 6;
    std::vector<std::unique_ptr<test::VirtualLightStage>> stages_;
    std::vector<LightTrees> light_trees_;
};

TEST_F(FurnaceEdges, AreNeitherDarkNorBlotchySlow) {
    const double middle = along(2.0f, {0.25f}).first;
    const std::pair<float, double> most_scatter[] = {{0.02f, 0.45}, {0.08f, 0.25}, {0.2f, 0.11}, {0.4f, 0.06}};
    for (const auto& [metres, most] : most_scatter) {
        const auto [mean, scatter] = along(metres, {0.25f});
        EXPECT_GT(mean, 0.82 * middle) << metres;
        EXPECT_LT(mean, 1.08 * middle) << metres;
        EXPECT_LT(scatter, most) << metres;
    }
    // Points alone show every VPL near an edge.
    EXPECT_GT(along(0.02f, GeometryClamp::none()).second, 0.45);
}

}  // namespace
}  // namespace render2mpeg::renderer
