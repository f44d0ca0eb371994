#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/color.h"
#include "renderer/caustics/caustics.h"
#include "renderer/lights/light_points.h"
#include "stage.h"

namespace render2mpeg::test {
namespace {

using renderer::CausticCounts;
using renderer::Caustics;
using renderer::CausticSettings;
using renderer::Frame;
using renderer::GatherPoint;

const glm::vec3 lamp_at(-1.5f, 2.0f, 0.3f);
constexpr float lamp_intensity = 10, mirrored = 0.8f;

/// A wet floor, a mirror of 4 x 3 that stands at x = 0, and a lamp before it.
SceneBuilder wet_floor(float roughness = 0.3f) {
    SceneBuilder b;
    const int wet = b.add_material({0.05f, 0.05f, 0.05f});
    b.material(wet).ior = 1.5f;
    b.material(wet).roughness = roughness;
    b.add_quad({-8, 0, 6}, {16, 0, 0}, {0, 0, -12}, wet);
    const int silver = b.add_material(glm::vec3(mirrored));
    b.material(silver).metallic = 1;
    b.material(silver).roughness = 0;
    b.material(silver).double_sided = true;
    b.add_quad({0, 0.01f, -2}, {0, 0, 4}, {0, 3, 0}, silver);
    b.add_point_light(lamp_at, lamp_intensity);
    // Looks along the way on which the floor mirrors what the mirror throws.
    b.add_camera({-4.5f, 1.5f, 0.2f}, {-2.4f, 0, 0.25f}, 0.5f);
    return b;
}

TEST(CausticsInALobe, OfAFlatMirrorAreTheMirroredLampsHoweverFewPhotonsThereAre) {
    Stage stage(wet_floor(), 48, 48);
    renderer::LightPoints points(stage.posed_scene(), stage.plan(), 256, 1);
    points.place(const_cast<renderer::PosedScene&>(stage.posed_scene()), stage.world());
    const Frame seen = stage.see(1);
    const glm::vec3 image(-lamp_at.x, lamp_at.y, lamp_at.z);
    for (const std::uint64_t photons : {1000, 30000}) {
        renderer::UngatheredLight light(seen);
        CausticCounts counts;
        Caustics caustics(CausticSettings{.photons = photons});
        caustics.add(stage.posed_scene(), points.at(stage.posed_scene()), nullptr, seen, light, counts);
        double sum = 0, expected = 0, error = 0;
        for (std::size_t t = 0; t < seen.tiles.size(); ++t)
            for (const GatherPoint& g : seen.tiles[t]) {
                const glm::vec3 way = image - g.point.position, to = glm::normalize(way);
                // Where the light comes off the middle of the mirror.
                const float along = -g.point.position.x / way.x;
                const glm::vec3 off = g.point.position + along * way;
                if (!(std::abs(off.z) < 1.2f) || !(off.y > 0.8f && off.y < 2.2f)) continue;
                const double truth = static_cast<double>(
                    core::luminance(g.weight * evaluate(g.point.bsdf, g.point.shading_normal, g.point.outgoing, to)) *
                    glm::dot(g.point.shading_normal, to) * mirrored * lamp_intensity / glm::dot(way, way));
                const glm::ivec2 at = seen.place_of(t, g.pixel);
                const double found =
                    static_cast<double>(core::luminance(renderer::value_or_zero(light.caustics().all, at.x, at.y)));
                sum += found;
                expected += truth;
                error += std::abs(found - truth);
            }
        EXPECT_GT(expected, 0.0);
        EXPECT_NEAR(sum / expected, 1.0, 0.04) << photons;
        EXPECT_LT(error / expected, photons > 10000 ? 0.05 : 0.2) << photons;
    }
}

/// A panel that shines on the mirror.
const glm::vec3 panel_corner(-1.5f, 1.4f, -0.1f), panel_edges[2]{{0, 0.4f, 0}, {0, 0, 0.8f}};
constexpr float panel_radiance = 2;

/// Light of a point by the panel's image, on an even grid.
double mirrored_panel(const GatherPoint& g) {
    constexpr int steps = 40;
    const float area = glm::length(panel_edges[0]) * glm::length(panel_edges[1]) / (steps * steps);
    double sum = 0;
    for (int i = 0; i < steps * steps; ++i) {
        const glm::vec2 u((static_cast<float>(i % steps) + 0.5f) / steps,
                          (static_cast<float>(i / steps) + 0.5f) / steps);
        glm::vec3 image = panel_corner + u.x * panel_edges[0] + u.y * panel_edges[1];
        image.x = -image.x;
        const glm::vec3 way = image - g.point.position, to = glm::normalize(way);
        const float cosines = std::max(glm::dot(g.point.shading_normal, to), 0.0f) * std::max(to.x, 0.0f);
        const glm::vec3 sent = g.weight * evaluate(g.point.bsdf, g.point.shading_normal, g.point.outgoing, to);
        sum += static_cast<double>(core::luminance(sent) * cosines / glm::dot(way, way) * area);
    }
    return sum * static_cast<double>(mirrored * panel_radiance);
}

TEST(CausticsInALobe, OfAPanelAreItsImageHoweverFewLightPointsItHas) {
    SceneBuilder b = wet_floor(0.15f);
    const int bright = b.add_material({0, 0, 0});
    b.material(bright).emission = glm::vec3(panel_radiance);
    b.add_quad(panel_corner, panel_edges[0], panel_edges[1], bright);
    b.film().lights.clear();
    Stage stage(b, 48, 48);
    renderer::LightPoints points(stage.posed_scene(), stage.plan(), 2, 1);
    points.place(const_cast<renderer::PosedScene&>(stage.posed_scene()), stage.world());
    const Frame seen = stage.see(1);
    renderer::UngatheredLight light(seen);
    CausticCounts counts;
    Caustics caustics(CausticSettings{.photons = 120000});
    caustics.add(stage.posed_scene(), points.at(stage.posed_scene()), nullptr, seen, light, counts);
    double sum = 0, expected = 0, error = 0;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t)
        for (const GatherPoint& g : seen.tiles[t]) {
            const double truth = mirrored_panel(g);
            const glm::ivec2 at = seen.place_of(t, g.pixel);
            const auto found =
                static_cast<double>(core::luminance(renderer::value_or_zero(light.caustics().all, at.x, at.y)));
            sum += found;
            expected += truth;
            error += std::abs(found - truth);
        }
    EXPECT_GT(expected, 0.0);
    RecordProperty("error", std::to_string(error / expected));
    EXPECT_NEAR(sum / expected, 1.0, 0.05);
    EXPECT_LT(error / expected, 0.25);
}

TEST(CausticsInALobe, AreBlurredByWhatAKernelDoesNotKnowOfDirections) {
    renderer::Landing landing;
    landing.direction = landing.normal = {0, -1, 0};
    landing.edges = {glm::vec3(0.1f, 0, 0), glm::vec3(0, 0, 0.1f), glm::vec3(0), glm::vec3(0)};
    landing.turns = {glm::vec3(0.02f, 0, 0), glm::vec3(0, 0, 0.02f), glm::vec3(0), glm::vec3(0)};
    const float turn2 = 0.02f * 0.02f / 6, one = 2 * turn2;
    EXPECT_NEAR(footprint_of(landing, 0, 1).blur, one * one / 2, 1e-3f * one) << "one direction for each place";

    landing.edges[2] = landing.edges[0];
    landing.turns[2] = -landing.turns[0];
    EXPECT_NEAR(footprint_of(landing, 0, 1).blur, 2 * turn2, 1e-2f * turn2) << "two directions along x";

    for (glm::vec3& turn : landing.turns) turn *= 200.0f;
    const renderer::Footprint bent = footprint_of(landing, 0, 1);
    EXPECT_NEAR(bent.blur, 3 * 200 * 200 * turn2, 1e-2f) << "no direction is known";
    EXPECT_EQ(bent.turn[0], glm::vec3(0));
}

}  // namespace
}  // namespace render2mpeg::test
