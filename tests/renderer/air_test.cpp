#include "renderer/base/air.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "renderer/air/air_lamp.h"
#include "renderer/lights/area_lamps.h"
#include "tests/renderer/film_stage.h"

/// Fog by closed forms and by sums over steps.
namespace render2mpeg::renderer {
namespace {

using test::SceneBuilder;

constexpr double pi = std::numbers::pi;
constexpr float endless_way = std::numeric_limits<float>::infinity();

core::Fog layered(float visibility, float height, float falloff) {
    core::Fog fog;
    fog.visibility = visibility;
    fog.height = height;
    fog.falloff = falloff;
    return fog;
}

FogMedium air_of(const core::Fog& fog) {
    return FogMedium(fog, glm::vec3(-10), glm::vec3(10));
}

/// Optical depth by the middles of so many steps.
double summed_depth(const core::Fog& fog, glm::dvec3 from, glm::dvec3 direction, double distance) {
    constexpr int steps = 20000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double y = from.y + (i + 0.5) / steps * distance * direction.y;
        sum += 3.0 / fog.visibility * (fog.falloff > 0 ? std::exp((fog.height - y) / fog.falloff) : 1.0);
    }
    return sum * distance / steps;
}

TEST(Air, DepthIsTheIntegralOfTheExtinction) {
    for (const float falloff : {0.0f, 0.7f, 5.0f, 1e6f})
        for (const float slope : {-1.0f, -0.3f, -1e-4f, 0.0f, 1e-7f, 0.02f, 0.6f, 1.0f})
            for (const float distance : {0.01f, 1.0f, 6.0f}) {
                const core::Fog fog = layered(20, 1, falloff);
                const glm::vec3 from(0.5f, 2, 0), direction(std::sqrt(1 - slope * slope), slope, 0);
                const double wanted = summed_depth(fog, from, direction, distance);
                EXPECT_NEAR(air_of(fog).optical_depth(from, direction, distance), wanted, 1e-4 * wanted)
                    << falloff << " " << slope << " " << distance;
            }
}

TEST(Air, ThatHardlyThinsOutIsHomogeneous) {
    const glm::vec3 from(0, 3, 0), up = glm::normalize(glm::vec3(1, 0.4f, 0));
    const float even = air_of(layered(20, 3, 0)).optical_depth(from, up, 7);
    EXPECT_NEAR(air_of(layered(20, 3, 1e9f)).optical_depth(from, up, 7), even, 1e-6 * even);
}

TEST(Air, EndsSomewhereAboveAndNowhereBelow) {
    const FogMedium air = air_of(layered(30, 0, 2));
    EXPECT_NEAR(air.optical_depth({0, 1, 0}, {0, 1, 0}, endless_way), 0.1 * std::exp(-0.5) * 2, 1e-6);
    EXPECT_TRUE(std::isinf(air.optical_depth({0, 1, 0}, {0, -1, 0}, endless_way)));
    EXPECT_TRUE(std::isinf(air.optical_depth({0, 1, 0}, {1, 0, 0}, endless_way)));
    EXPECT_TRUE(std::isinf(air_of(layered(30, 0, 0)).optical_depth({0, 1, 0}, {0, 1, 0}, endless_way)));
    // Light of the sky is dimmed within the box alone where fog is homogeneous.
    EXPECT_NEAR(air_of(layered(30, 0, 0)).depth_to_sky({0, 4, 0}, {0, 1, 0}), 0.6, 1e-6);
    EXPECT_EQ(air_of(layered(30, 0, 0)).depth_to_sky({0, 40, 0}, {0, 1, 0}), 0);
}

TEST(Air, IsFiniteFarFromItsHeight) {
    for (const float y : {-1e6f, -100.0f, 100.0f, 1e6f})
        for (const float slope : {-1.0f, 0.0f, 1.0f}) {
            const FogMedium air = air_of(layered(30, 0, 0.01f));
            const glm::vec3 from(0, y, 0), direction(std::sqrt(1 - slope * slope), slope, 0);
            EXPECT_FALSE(std::isnan(air.optical_depth(from, direction, 5)));
            EXPECT_FALSE(std::isnan(air.optical_depth(from, direction, endless_way)));
            EXPECT_FALSE(std::isnan(air.depth_to_sky(from, direction)));
            EXPECT_FALSE(std::isnan(air.distance_at(from, direction, 0.5f)));
        }
    EXPECT_EQ(Air(air_of(layered(core::least_visibility, 0, 0)), {}).transmittance({0, 0, 0}, {1, 0, 0}, 1).x, 0);
    EXPECT_NEAR(Air(air_of(layered(core::most_visibility, 0, 0)), {}).transmittance({0, 0, 0}, {1, 0, 0}, 1).x, 1,
                1e-6);
}

TEST(Air, TellsHowFarADepthReaches) {
    for (const float falloff : {0.0f, 0.7f, 5.0f})
        for (const float slope : {-1.0f, -0.3f, 0.0f, 0.02f, 0.6f})
            for (const float distance : {0.01f, 1.0f, 4.0f}) {
                const FogMedium air = air_of(layered(20, 1, falloff));
                const glm::vec3 from(0.5f, 2, 0), direction(std::sqrt(1 - slope * slope), slope, 0);
                const float depth = air.optical_depth(from, direction, distance);
                EXPECT_NEAR(air.distance_at(from, direction, depth), distance, 1e-3f * distance) << falloff << slope;
            }
}

TEST(Air, LeavesFivePercentOfContrastAtItsVisibility) {
    EXPECT_NEAR(Air(air_of(layered(40, 0, 0)), {}).transmittance({0, 0, 0}, {0, 0, 1}, 40).x, 0.05, 0.0003);
}

TEST(Air, ScattersAllOfWhatItScatters) {
    for (const float g : {-0.9f, 0.0f, 0.5f, 0.95f}) {
        core::Fog fog = layered(10, 0, 0);
        fog.anisotropy = g;
        double sum = 0, mean = 0;
        constexpr int steps = 200000;
        for (int i = 0; i < steps; ++i) {
            const double cosine = -1 + 2 * (i + 0.5) / steps;
            const double p = 4 * pi / steps * static_cast<double>(phase(fog.anisotropy, static_cast<float>(cosine)));
            sum += p;
            mean += p * cosine;
        }
        EXPECT_NEAR(sum, 1, 1e-3);
        EXPECT_NEAR(mean, g, 1e-3);
    }
}

/// A scene of rays without surfaces, or with a bar.
class Empty {
  public:
    explicit Empty(const SceneBuilder& builder)
        : film_(builder.build()),
          tracer_(film_, core::detect_isa(), std::vector<bool>(film_.materials.size(), false),
                  [](const auto&, auto, auto) { return glm::vec3(0); }),
          world_(test::snapshot(film_, 0, 16, 16)) {
        tracer_.pose(world_);
    }
    /// Of a lamp, by 16 cells.
    float scattered(const Air& air, const LightPoint& lamp, glm::vec3 from, glm::vec3 direction, float far) const {
        glm::vec3 sum(0);
        const float ends[1] = {far};
        add_scattered({air, tracer_, Bodies::pass}, lamp, {from, direction, ends, 0}, 16, &sum);
        return sum.x;
    }

  private:
    scene::Animation film_;
    RayTracer tracer_;
    scene::Snapshot world_;
};

/// Of a point lamp of intensity 1 that shines between two distances.
double summed_light(const core::Fog& fog, glm::dvec3 lamp, glm::dvec3 direction, double from, double to) {
    constexpr int steps = 100000;
    const double sigma = 3.0 / fog.visibility, g = fog.anisotropy;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double t = from + (to - from) * (i + 0.5) / steps;
        const glm::dvec3 way = t * direction - lamp;
        const double r = glm::length(way), cosine = glm::dot(way / r, -direction);
        const double phase = (1 - g * g) / (4 * pi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
        sum += sigma * phase * std::exp(-sigma * (t + r)) / (r * r) * (to - from) / steps;
    }
    return sum;
}

TEST(Airlight, OfAPointLampIsTheSumOverSteps) {
    const Empty empty{SceneBuilder()};
    const glm::vec3 along(0, 0, -1);
    for (const float visibility : {2.0f, 10.0f, 1000.0f})
        for (const float g : {-0.5f, 0.0f, 0.8f})
            for (const glm::vec3 place : {glm::vec3(0.02f, 0, -3), glm::vec3(2, 1, -5), glm::vec3(1, 0, 4)}) {
                core::Fog fog = layered(visibility, 0, 0);
                fog.anisotropy = g;
                LightPoint lamp;
                lamp.type = LightType::punctual;
                lamp.position = place;
                lamp.intensity = glm::vec3(1);
                for (const float far : {2.0f, 9.0f}) {
                    const double wanted = summed_light(fog, place, along, 0, far);
                    EXPECT_NEAR(empty.scattered(Air(air_of(fog), {}), lamp, glm::vec3(0), along, far), wanted,
                                0.02 * wanted)
                        << visibility << " " << g << " " << place.x << " " << far;
                }
            }
}

TEST(Airlight, OfASunIsTheClosedForm) {
    const Empty empty{SceneBuilder()};
    const core::Fog fog = layered(15, 0, 0);
    LightPoint sun;
    sun.type = LightType::directional;
    sun.normal = {0, -1, 0};
    sun.intensity = glm::vec3(3);
    // Beyond the box light comes undimmed.
    const Air air(FogMedium(fog, glm::vec3(0), glm::vec3(0)), {});
    for (const float far : {1.0f, 40.0f})
        EXPECT_NEAR(empty.scattered(air, sun, {0, 50, 0}, {1, 0, 0}, far),
                    3 / (4 * pi) * (1 - std::exp(-0.2 * static_cast<double>(far))), 1e-4);
    EXPECT_NEAR(empty.scattered(air, sun, {0, 50, 0}, {1, 0, 0}, endless_way), 3 / (4 * pi), 1e-4);
}

TEST(Airlight, IsDarkBehindABar) {
    // A bar between lamp and ray, whose shadow on the ray is from 2.5 to 3.75 before the lamp's height.
    SceneBuilder b;
    b.add_quad({1, -1, -3.375f}, {0, 2, 0}, {0, 0, 0.625f}, b.add_material());
    b.material(0).double_sided = true;
    const Empty scene{b};
    const core::Fog fog = layered(20, 0, 0);
    LightPoint lamp;
    lamp.type = LightType::punctual;
    lamp.position = {2, 0, -4};
    lamp.intensity = glm::vec3(1);
    const glm::vec3 along(0, 0, -1);
    // The bar is half way: lamp + 2 (bar - lamp).
    const double dark = summed_light(fog, lamp.position, along, 1.5, 2.75),
                 all = summed_light(fog, lamp.position, along, 0, 9);
    EXPECT_NEAR(scene.scattered(Air(air_of(fog), {}), lamp, glm::vec3(0), along, 9), all - dark, 0.01 * all);
    EXPECT_GT(dark, 0.05 * all);
}

TEST(Airlight, OfARoundLampIsThatOfAPointOfItsIntensity) {
    // Its own ball is in the scene.
    SceneBuilder b;
    b.add_sphere({2, 0, -4}, 0.1f, b.add_material());
    const Empty scene{b};
    const core::Fog fog = layered(20, 0, 0);
    LightTrees light_trees;
    const glm::vec3 place(2, 0, -4);
    const auto ball = sphere_lamp(place, 0.1f, 1e-4f);
    ball->radiance = glm::vec3(1 / (std::numbers::pi_v<float> * 0.01f));
    light_trees.lamps.push_back(ball);
    const std::vector<LightPoint> lamps = air_lamps({}, light_trees);
    ASSERT_EQ(lamps.size(), 1u);
    const glm::vec3 along(0, 0, -1);
    const double wanted = summed_light(fog, place, along, 0, 9);
    EXPECT_NEAR(scene.scattered(Air(air_of(fog), {}), lamps[0], glm::vec3(0), along, 9), wanted, 0.02 * wanted);
}

TEST(Airlight, OfASpotIsThatOfItsCone) {
    const Empty empty{SceneBuilder()};
    const core::Fog fog = layered(20, 0, 0);
    LightPoint lamp;
    lamp.type = LightType::punctual;
    lamp.position = {0, 2, -3};
    lamp.normal = {0, -1, 0};
    lamp.intensity = glm::vec3(1);
    // A hard edge at 30 degrees, but for a hundredth.
    const float outer = std::cos(0.52359878f), inner = outer + 0.001f;
    lamp.spot = {1 / (inner - outer), -outer / (inner - outer)};
    const double half = 2 * std::tan(0.52359878), sigma = 0.15;
    double wanted = 0;
    constexpr int steps = 20000;
    for (int i = 0; i < steps; ++i) {
        const double s = -half + 2 * half * (i + 0.5) / steps, r = std::hypot(s, 2.0);
        wanted += sigma / (4 * pi) * std::exp(-sigma * (3 + s + r)) / (r * r) * 2 * half / steps;
    }
    EXPECT_NEAR(empty.scattered(Air(air_of(fog), {}), lamp, glm::vec3(0), {0, 0, -1}, 9), wanted, 0.02 * wanted);
}

/// Light of fog before a black wall, over a floor of this grey that a lamp lights.
float fog_over_floor(float grey, bool bounces, Indirect indirect) {
    SceneBuilder b;
    b.add_quad({-8, -2, -4}, {16, 0, 0}, {0, 16, 0}, b.add_material(glm::vec3(0)));
    b.add_quad({-8, -2, 8}, {16, 0, 0}, {0, 0, -12}, b.add_material(glm::vec3(grey)));
    b.add_point_light({0, -1, -2}, 20);
    b.add_camera({0, 1, 4}, {0, 1.5f, 0}, 0.3f);
    b.film().sky.color = glm::vec3(0.01f);
    b.film().fog.visibility = 20;
    b.film().fog.bounces = bounces;
    Settings settings = test::small_frame();
    settings.indirect = indirect;
    test::FilmStage stage(b, settings);
    return stage.cut(0.01f).combined.at(12, 12).x;
}

TEST(Airlight, OfBouncedLightIsThereUnlessTheFogIsLitDirectlyAlone) {
    for (const Indirect indirect : {Indirect::rays, Indirect::lightcuts}) {
        const float direct = fog_over_floor(0, false, indirect);
        EXPECT_GT(direct, 0.01f);
        EXPECT_NEAR(fog_over_floor(0.9f, false, indirect), direct, 1e-4f * direct);
        EXPECT_GT(fog_over_floor(0.9f, true, indirect), 1.1f * direct);
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
