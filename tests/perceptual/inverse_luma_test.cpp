#include "perceptual/inverse_luma.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/color.h"
#include "core/sampling.h"
#include "perceptual/display.h"

namespace render2mpeg::perceptual {
namespace {

PixelLight light_of(const Display& display, const std::vector<glm::vec3>& colors) {
    core::Radiance radiance;
    radiance.combined = core::Plane<glm::vec3>(static_cast<int>(colors.size()), 1);
    std::copy(colors.begin(), colors.end(), radiance.combined.row(0));
    return InverseLuma(display).light_of(display.develop(radiance), radiance);
}

double luminance_of_grey(const Display& display, float luma) {
    return static_cast<double>(core::luminance(display.with_luma(glm::vec3(1.0f), luma)));
}

/// What a quarter of a code value above black counts as.
constexpr float darkest = 16.25f;

/// By how much light differs from luma `from` to the one `distance` below, scaled at its own chromaticity; nearer to
/// black than that, what it has at that distance from black, but no more than grey has, or than all of its own light.
double exact_difference(const Display& display, glm::vec3 color, float from, float distance) {
    const auto at = [&](float luma) { return static_cast<double>(core::luminance(display.with_luma(color, luma))); };
    const double light = static_cast<double>(core::luminance(color));
    if (from - distance >= darkest) return light - at(from - distance);
    const float to = std::min(darkest + distance, 235.0f);
    return std::min(at(to) - at(darkest),
                    std::max(light, luminance_of_grey(display, to) - luminance_of_grey(display, darkest)));
}

TEST(InverseLuma, IsTheInverseOfTheDisplayForGrey) {
    for (const float exposure : {-3.0f, 0.0f, 5.0f}) {
        const Display display(exposure, ColorMatrix::bt709);
        const InverseLuma light(display);
        for (float luma = 17.0f; luma < 220.0f; luma += 3.7f)
            for (const float distance : {0.5f, 1.0f, 12.0f}) {
                const glm::vec3 grey = display.with_luma(glm::vec3(1.0f), luma);
                const double exact = exact_difference(display, grey, luma, distance);
                const double ours = light.difference(luma, core::luminance(grey), 1.0f, distance);
                EXPECT_NEAR(ours, exact, 0.02 * exact) << luma << " " << distance;
            }
    }
}

TEST(InverseLuma, IsNearlyTheInverseForColours) {
    const Display display(0.5f, ColorMatrix::bt601);
    const InverseLuma light(display);
    std::vector<glm::vec3> colors;
    for (std::uint64_t i = 0; i < 4000; ++i)
        colors.push_back(glm::vec3(core::uniform(1, i), core::uniform(2, i), core::uniform(3, i)) *
                         std::exp2(6.0f * core::uniform(4, i) - 5.0f));
    const PixelLight pixels = light_of(display, colors);
    std::vector<double> errors;
    for (std::size_t i = 0; i < colors.size(); ++i)
        for (const float distance : {20.0f, 5.0f, 1.0f}) {
            const float luma = pixels.luma.values()[i];
            if (luma < 17.0f) continue;
            const double exact = exact_difference(display, colors[i], luma, distance);
            const double ours =
                light.difference(luma, pixels.luminance.values()[i], pixels.exponent.values()[i], distance);
            errors.push_back(std::abs(ours / exact - 1.0));
        }
    std::sort(errors.begin(), errors.end());
    ASSERT_GT(errors.size(), 10000u);
    EXPECT_LT(errors[errors.size() / 2], 0.01);
    EXPECT_LT(errors[errors.size() * 99 / 100], 0.25);
}

TEST(InverseLuma, GrowsWithTheDistanceOnEitherSideOfWhereBlackCutsItOff) {
    const InverseLuma light(Display(0.0f, ColorMatrix::bt709));
    for (const float luma : {16.0f, 20.0f, 40.0f, 130.0f, 234.9f, 235.0f}) {
        float before = 0;
        for (float distance = 0.5f; distance < 200.0f; distance *= 1.3f) {
            const float now = light.difference(luma, 0.3f, 1.0f, distance);
            EXPECT_GE(now, 0.99f * before) << luma << " " << distance;
            before = now;
        }
    }
}

TEST(InverseLuma, HasNoStepNextToBlackAndNeverExceedsTheDistanceUpward) {
    const Display display(0.7f, ColorMatrix::bt709);
    const InverseLuma light(display);
    for (const glm::vec3 hue : {glm::vec3(1.0f), glm::vec3(0.9f, 0.6f, 0.3f), glm::vec3(0.2f, 0.5f, 0.9f)}) {
        std::vector<glm::vec3> colors;
        for (float luma = 16.3f; luma < 140.0f; luma += 0.05f) colors.push_back(display.with_luma(hue, luma));
        const PixelLight p = light_of(display, colors);
        for (const float distance : {0.5f, 8.0f, 24.0f, 60.0f}) {
            float before = 0;
            for (std::size_t i = 0; i < colors.size(); ++i) {
                const float luma = p.luma.values()[i], luminance = p.luminance.values()[i];
                const float now = light.difference(luma, luminance, p.exponent.values()[i], distance);
                if (before > 0) {
                    EXPECT_NEAR(now / before, 1.0f, 0.05f) << luma << " " << distance;
                }
                before = now;
                EXPECT_LT(luma_of(display, colors[i] * (1.0f + now / luminance)), luma + 1.05f * distance + 0.3f)
                    << luma << " " << distance;
            }
        }
    }
}

TEST(InverseLuma, NextToWhiteNoMoreThanAllLightIsTolerated) {
    const InverseLuma light(Display(0.0f, ColorMatrix::bt709));
    for (const float distance : {0.5f, 4.0f, 20.0f, 200.0f})
        EXPECT_LE(light.difference(234.9f, 3.0f, 1.0f, distance), 3.0f);
}

TEST(InverseLuma, ColoursWhoseLumaEndsEarlyAreAllowedNoMoreThanGreyOrTheirLight) {
    // Blue's luma ends near 32: a distance upward from there would hold any light at all.
    const Display display(0.0f, ColorMatrix::bt709);
    const InverseLuma light(display);
    const std::vector<glm::vec3> colors{{0, 0, 0.2f}, {0, 0, 5}, {0, 0, 1e9f}, {0.3f, 0, 0.3f}};
    const PixelLight pixels = light_of(display, colors);
    for (std::size_t i = 0; i < colors.size(); ++i)
        for (const float distance : {0.5f, 8.0f, 31.0f}) {
            const float luma = pixels.luma.values()[i], luminance = pixels.luminance.values()[i];
            ASSERT_GT(luma, 16.25f) << i;
            const double grey = luminance_of_grey(display, luma + distance) - luminance_of_grey(display, luma);
            EXPECT_LE(light.difference(luma, luminance, pixels.exponent.values()[i], distance),
                      1.01 * std::max(static_cast<double>(luminance), grey))
                << i << " " << distance;
        }
}

TEST(InverseLuma, IsPositiveAndFiniteEverywhere) {
    for (const float exposure : {-64.0f, 0.0f, 64.0f}) {
        const Display display(exposure, ColorMatrix::bt709);
        const std::vector<glm::vec3> colors{glm::vec3(0),          glm::vec3(1e-30f), {0, 0, 1e-3f}, {1e-8f, 0, 0},
                                            {1e30f, 1e30f, 1e30f}, {0, 0, 1e30f},     {1, 1e9f, 0},  glm::vec3(0.18f)};
        const InverseLuma light(display);
        const PixelLight pixels = light_of(display, colors);
        for (std::size_t i = 0; i < colors.size(); ++i)
            for (const float distance : {1e-3f, 0.5f, 20.0f, 400.0f}) {
                const float d = light.difference(pixels.luma.values()[i], pixels.luminance.values()[i],
                                                 pixels.exponent.values()[i], distance);
                EXPECT_TRUE(std::isfinite(d)) << exposure << " " << i << " " << distance;
                EXPECT_GT(d, 0.0f) << exposure << " " << i << " " << distance;
            }
    }
}

TEST(InverseLuma, ADarkStepIsHalfACodeValueAboveBlack) {
    const Display display(1.5f, ColorMatrix::bt709);
    const double exact = static_cast<double>(core::luminance(display.with_luma(glm::vec3(1.0f), 16.5f)));
    EXPECT_NEAR(static_cast<double>(InverseLuma(display).darkest_step()), exact, 1e-4 * exact);
}

}  // namespace
}  // namespace render2mpeg::perceptual
