#include "renderer/base/lit_fog.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/color.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

/// Fog of 8 cells from 0 to 4 whose corners see everywhere; their light is x + 2 y + 3 z.
LitFog sloped_light() {
    LitFog lit({0, 0, 0}, {4, 4, 4}, {2, 2, 2});
    for (std::size_t i = 0; i < lit.corners().size(); ++i) {
        lit.corners()[i].clear.fill(100);
        lit.corners()[i].rest = glm::vec3(glm::dot(lit.place_of(i), glm::vec3(1, 2, 3)));
    }
    return lit;
}

FogMedium even_fog(float visibility) {
    core::Fog fog;
    fog.visibility = visibility;
    return {fog, glm::vec3(0), glm::vec3(4)};
}

TEST(LitFog, IsLinearBetweenCornersAndThatOfItsBorderBeyond) {
    const LitFog lit = sloped_light();
    for (const glm::vec3 place :
         {glm::vec3(0.3f, 1.9f, 3.7f), glm::vec3(2, 2, 2), glm::vec3(4, 0, 0), glm::vec3(3.99f)})
        EXPECT_NEAR(lit.rest_at(place).x, glm::dot(place, glm::vec3(1, 2, 3)), 1e-4f);
    EXPECT_NEAR(lit.rest_at({9, -3, 2}).x, 4 + 6, 1e-4f);
}

TEST(LitFog, SharesSumUpToWhatTheFogTakesWithinTheBox) {
    const LitFog lit = sloped_light();
    const FogMedium fog = even_fog(6);
    const float inf = std::numeric_limits<float>::infinity();
    for (const float far : {0.5f, 3.0f, inf})
        for (const float from : {-2.0f, 0.0f, 1.0f}) {
            double sum = 0;
            lit.along(fog, {from, 1, 1}, {1, 0, 0}, far, [&](glm::vec3 place, float share) {
                EXPECT_GE(place.x, 0.0f);
                EXPECT_LE(place.x, 4.0f);
                sum += static_cast<double>(share);
            });
            const float begin = std::max(-from, 0.0f), end = std::min(far, 4.0f - from);
            const double taken =
                end > begin ? std::exp(-0.5 * static_cast<double>(begin)) - std::exp(-0.5 * static_cast<double>(end))
                            : 0.0;
            EXPECT_NEAR(sum, taken, 2e-3) << from << ", " << far;
        }
    bool any = false;
    const auto visit = [&](glm::vec3, float) { any = true; };
    lit.along(fog, {1, 9, 1}, {1, 0, 0}, inf, visit);
    lit.along(fog, {-1, 1, 1}, {-1, 0, 0}, inf, visit);
    LitFog().along(fog, {1, 1, 1}, {1, 0, 0}, inf, visit);
    EXPECT_FALSE(any);
}

TEST(LitFog, CornersLightNothingBeyondAWall) {
    LitFog lit({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
    for (std::size_t i = 0; i < 8; ++i) {
        // A wall at x = 0.7, and light before it.
        const bool before = lit.place_of(i).x < 0.5f;
        lit.corners()[i].rest = glm::vec3(before ? 1.0f : 0.0f);
        lit.corners()[i].clear.fill(before ? 0.7f : 0.3f);
    }
    EXPECT_NEAR(lit.rest_at({0.5f, 0, 0}).x, 1, 1e-6f);
    EXPECT_EQ(lit.rest_at({0.9f, 0, 0}).x, 0);
    for (LitFog::Corner& c : lit.corners()) c.clear.fill(0);
    EXPECT_EQ(lit.rest_at({0.5f, 0.5f, 0.5f}).x, 0);
}

// Under a sky that is the same everywhere all is as bright as it, whatever does not absorb is within.
TEST(LitFog, UnderAnEvenSkyIsAsBrightAsThat) {
    for (const float visibility : {3.0f, 12.0f}) {
        SceneBuilder b;
        const int white = b.add_material({1, 1, 1});
        b.add_sphere({0.5f, 0.5f, 0.5f}, 0.5f, white);
        b.add_sphere({3.5f, 2.5f, 4.5f}, 0.5f, white);
        b.film().sky.color = {1, 1, 1};
        b.add_camera({2, 1.4f, 4.6f}, {2, 1.3f, 0});
        b.film().fog.visibility = visibility;
        b.film().fog.color = {1, 1, 1};
        FilmStage stage(b, test::small_frame(12, 9));
        const core::Radiance frame = stage.reference();
        double sum = 0;
        for (const glm::vec3& light : frame.combined.values()) {
            sum += static_cast<double>(light.y);
            EXPECT_NEAR(light.y, 1.0f, 0.08f) << visibility;
        }
        EXPECT_NEAR(sum / static_cast<double>(frame.combined.size()), 1.0, 0.03) << visibility;
    }
}

// A black wall in a lamp's fog is seen by nobody; a white one that the lamp does not reach is lit by the fog.
TEST(LitFog, LightsSurfaces) {
    const auto behind_a_screen = [](float visibility) {
        SceneBuilder b;
        const int white = b.add_material({0.8f, 0.8f, 0.8f}), black = b.add_material({0, 0, 0});
        b.add_box({0, 0, 0}, {4, 3, 6}, black, true);
        b.add_quad({0.01f, 0.01f, 0.01f}, {3.98f, 0, 0}, {0, 2.98f, 0}, white);
        b.add_box({1, 0, 2.8f}, {3, 2.4f, 3}, black);
        b.add_point_light({2, 0.6f, 3.3f}, 20.0f, {1, 1, 1});
        b.add_camera({2, 2.7f, 2.7f}, {2, 1.2f, 0});
        b.film().fog.visibility = visibility;
        b.film().fog.color = {1, 1, 1};
        FilmStage stage(b, test::small_frame(8, 8));
        return stage.reference().combined;
    };
    const auto clear = behind_a_screen(1e5f), foggy = behind_a_screen(12);
    double without = 0, with = 0;
    for (const glm::vec3& light : clear.values()) without += static_cast<double>(light.y);
    for (const glm::vec3& light : foggy.values()) with += static_cast<double>(light.y);
    EXPECT_GT(with, without);
}

}  // namespace
}  // namespace render2mpeg::renderer
