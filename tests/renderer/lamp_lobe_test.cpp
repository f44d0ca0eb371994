// Highlights of area lamps: the integral of the lobe over the lamp.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <tuple>

#include "core/sampling.h"
#include "renderer/cut/lamp_samples.h"
#include "renderer/lights/area_lamps.h"
#include "renderer/surface/bsdf.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr double half_turn = std::numbers::pi;

/// What one direction of unit radiance sends to the eye.
using Scatters = std::function<double(glm::dvec3 direction)>;

/// A lamp over the floor, and the integral over its directions seen from a place.
struct Lamp {
    void (*add)(SceneBuilder&);
    double (*integral)(glm::dvec3 place, const Scatters& scatters);
};

constexpr glm::vec3 panel_corner{-0.6f, 0.3f, -1.2f}, panel_u{1.2f, 0, 0}, panel_v{0, 0.8f, 0};
constexpr float sun_irradiance = 0.2f, sun_angle = 0.06f;
const glm::vec3 sun_direction = glm::normalize(glm::vec3(0, -0.35f, 1));

void add_panel(SceneBuilder& b) {
    b.add_quad(panel_corner, panel_u, panel_v, b.add_emitter(glm::vec3(1)));
}
double over_panel(glm::dvec3 place, const Scatters& scatters) {
    if (place.z < panel_corner.z) return 0;
    constexpr int n = 250;
    const glm::dvec3 across = glm::cross(glm::dvec3(panel_u), glm::dvec3(panel_v));
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const glm::dvec3 d = glm::dvec3(panel_corner) + (i + 0.5) / n * glm::dvec3(panel_u) +
                                 (j + 0.5) / n * glm::dvec3(panel_v) - place;
            const double far = glm::length(d);
            sum += scatters(d / far) * std::abs(glm::dot(d, across)) / (far * far * far);
        }
    return sum / (n * n);
}

double over_cone(glm::dvec3 axis, double sine, const Scatters& scatters) {
    constexpr int n = 300;
    const double low = 1 - std::sqrt(1 - sine * sine);
    glm::vec3 t, b;
    core::make_frame(glm::vec3(axis), t, b);
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double cosine = 1 - low * (i + 0.5) / n, turn = 2 * half_turn * (j + 0.5) / n;
            const double across = std::sqrt(1 - cosine * cosine);
            sum += scatters(cosine * axis + across * (std::cos(turn) * glm::dvec3(t) + std::sin(turn) * glm::dvec3(b)));
        }
    return sum * 2 * half_turn * low / (n * n);
}

void add_ball(SceneBuilder& b) {
    b.add_sphere({0, 0.6f, -0.8f}, 0.4f, b.add_emitter(glm::vec3(1)), 96);
}
double over_ball(glm::dvec3 place, const Scatters& scatters) {
    const glm::dvec3 d = glm::dvec3(0, 0.6f, -0.8f) - place;
    return over_cone(glm::normalize(d), 0.4 / glm::length(d), scatters);
}

void add_soft_sun(SceneBuilder& b) {
    b.add_sun(sun_direction, sun_irradiance);
    b.film().lights.back().angle = sun_angle;
}
double over_sun(glm::dvec3, const Scatters& scatters) {
    const double sine = std::sin(sun_angle);
    return over_cone(-glm::dvec3(sun_direction), sine, scatters) * sun_irradiance / (half_turn * sine * sine);
}

const Lamp all_lamps[] = {{add_panel, over_panel}, {add_ball, over_ball}, {add_soft_sun, over_sun}};

TEST(LampSamples, OfASphereLieEvenlyBySolidAngleCloseToIt) {
    const auto ball = sphere_lamp({0, 1.01f, 0}, 1, 0);
    GatherPoint g;
    g.point.shading_normal = g.point.geometric_normal = {0, 1, 0};
    const GatherPoint* const points[] = {&g};
    GatherLanes lanes;
    fill(lanes, points);
    lanes.set = 0;
    const LampSampler sampler(*ball, lanes);
    double heights = 0;
    for (int k = 0; k < 64; ++k) {
        LampSamples samples;
        sampler.take(k, samples);
        heights += samples.direction.y[0] / 64;
    }
    const double cosine = std::sqrt(1 - 1 / (1.01 * 1.01));
    EXPECT_NEAR(heights, 0.5 * (1 + cosine), 0.01);
}

/// By lamp and roughness.
class Highlight : public testing::TestWithParam<std::tuple<int, float>> {};

TEST_P(Highlight, IsTheIntegralOfTheLobeOverTheLamp) {
    const Lamp& lamp = all_lamps[std::get<0>(GetParam())];
    SceneBuilder b;
    const int metal = b.add_material({1, 1, 1});
    b.material(metal).metallic = 1;
    b.material(metal).roughness = std::get<1>(GetParam());
    b.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, metal);
    lamp.add(b);
    b.add_camera({0, 0.8f, 2.5f}, {0, 0, 0.2f}, 0.5f);
    Settings settings = test::small_frame();
    settings.vpls = 0;
    FilmStage stage(b, settings);
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance exact = stage.reference(), frame = stage.cut(0.02f);
    double brightest = 0;
    for (const glm::vec3& v : exact.combined.values()) brightest = std::max<double>(brightest, v.x);
    // The ball is a mesh, and the truth a sum over cells.
    const double rounding = 0.005 * brightest;
    int compared = 0;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t)
        for (std::size_t i = t; i < seen.tiles[t].size(); i += 23) {
            const GatherPoint& g = seen.tiles[t][i];
            const SurfacePoint& p = g.point;
            if (p.address.object != 0) continue;
            const int x = static_cast<int>(t % 2) * tile_size + g.pixel % tile_size;
            const int y = static_cast<int>(t / 2) * tile_size + g.pixel / tile_size;
            const double truth = lamp.integral(p.position, [&](glm::dvec3 l) {
                const float cosine = glm::dot(p.shading_normal, glm::vec3(l));
                return cosine > 0 ? evaluate(p.bsdf, p.shading_normal, p.outgoing, glm::vec3(l)).x * cosine : 0;
            });
            if (truth < 0.01 * brightest) continue;
            ++compared;
            EXPECT_NEAR(exact.combined.at(x, y).x, truth, 0.005 * truth + rounding) << x << ", " << y;
            EXPECT_NEAR(frame.combined.at(x, y).x, truth, 0.02 * truth + rounding) << x << ", " << y;
        }
    EXPECT_GE(compared, 4);
}
INSTANTIATE_TEST_SUITE_P(OfLamps, Highlight, testing::Combine(testing::Values(0, 1, 2), testing::Values(0.8f)));
INSTANTIATE_TEST_SUITE_P(OfLampsSlow, Highlight,
                         testing::Combine(testing::Values(0, 1, 2), testing::Values(0.15f, 0.3f)));

}  // namespace
}  // namespace render2mpeg::renderer
