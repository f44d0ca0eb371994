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
    EXPECT_NEAR(lit.rest_at({0.5f, 0, 0}).x, 1, 2e-3f);
    EXPECT_NEAR(lit.rest_at({0.9f, 0, 0}).x, 0, 2e-3f);
    // Where none sees anything they count as they are near.
    for (LitFog::Corner& c : lit.corners()) c.clear.fill(0);
    EXPECT_NEAR(lit.rest_at({0.25f, 0.5f, 0.5f}).x, 0.75f, 1e-5f);
}

// Under a sky that is the same everywhere all is as bright as it, whatever does not absorb is within.
TEST(LitFog, UnderAnEvenSkyIsAsBrightAsThat) {
    for (const bool flat : {false, true})
        for (const float falloff : {0.0f, 2.0f})
            for (const float visibility : {3.0f, 12.0f}) {
                SceneBuilder b;
                const int white = b.add_material({1, 1, 1});
                b.add_sphere({0.1f, 0.1f, 0.1f}, 0.1f, white);
                b.add_sphere({3.9f, flat ? 0.1f : 2.9f, 4.9f}, 0.1f, white);
                b.film().sky.color = {1, 1, 1};
                b.add_camera({2, 1.4f, 4.6f}, {2, falloff > 0 ? 5.0f : 1.3f, 0});  // over the horizon of layers
                b.film().fog.visibility = visibility;
                b.film().fog.falloff = falloff;
                b.film().fog.color = {1, 1, 1};
                FilmStage stage(b, test::small_frame(12, 9));
                const core::Radiance frame = stage.reference();
                double sum = 0;
                for (const glm::vec3& light : frame.combined.values()) sum += static_cast<double>(light.y);
                EXPECT_NEAR(sum / static_cast<double>(frame.combined.size()), 1.0, falloff > 0 ? 0.15 : 0.05)
                    << flat << ", " << falloff << ", " << visibility;
            }
}

// A wall that no lamp reaches is lit by fog: what it adds to the picture of a black one.
TEST(LitFog, LightsSurfaces) {
    const auto behind_a_screen = [](float visibility, float reflectance) {
        SceneBuilder b;
        const int wall = b.add_material(glm::vec3(reflectance)), black = b.add_material({0, 0, 0});
        b.add_box({0, 0, 0}, {4, 3, 6}, black, true);
        b.add_quad({0.01f, 0.01f, 0.01f}, {3.98f, 0, 0}, {0, 2.98f, 0}, wall);
        b.add_box({1, 0, 2.8f}, {3, 2.4f, 3}, black);
        b.add_point_light({2, 0.6f, 3.3f}, 20.0f, {1, 1, 1});
        b.add_camera({2, 2.7f, 2.7f}, {2, 1.2f, 0});
        b.film().fog.visibility = visibility;
        b.film().fog.color = {1, 1, 1};
        FilmStage stage(b, test::small_frame(8, 8));
        const core::Radiance lit = stage.reference();
        double sum = 0;
        for (const glm::vec3& light : lit.combined.values()) sum += static_cast<double>(light.y);
        return sum;
    };
    const double clear = behind_a_screen(1e5f, 0.8f) - behind_a_screen(1e5f, 0);
    const double foggy = behind_a_screen(12, 0.8f) - behind_a_screen(12, 0);
    EXPECT_LT(clear, 0.01);
    EXPECT_NEAR(foggy, 1.07, 0.15);  // as it was found; no truth
}

}  // namespace
}  // namespace render2mpeg::renderer
