#include "perceptual/tolerance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/sampling.h"

namespace render2mpeg::perceptual {
namespace {

core::Block8x8 random_errors(int column, int row) {
    core::Block8x8 block;
    for (std::size_t i = 0; i < 64; ++i)
        block[i] = 10.0f * core::uniform(2, static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row), i);
    return block;
}

/// Grey light from black to bright.
PixelLight light_ramp(const Display& display, int width, int height) {
    core::Radiance radiance;
    radiance.combined = core::Plane<glm::vec3>(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            radiance.combined.at(x, y) = glm::vec3(std::exp2(12.0f * static_cast<float>(x) / width - 10.0f));
    return InverseLuma(display).light_of(display.develop(radiance), radiance);
}

TEST(Distances, KeepTheMeanSquareOfEqualBlocks) {
    const core::Block8x8 block = random_errors(0, 0);
    const core::Plane<float> plane = distances(33, 17, [&](int, int) { return block; });
    for (const float d : plane.values()) EXPECT_FLOAT_EQ(d, root_mean_square(block));
}

TEST(Distances, PrintNoEdges) {
    // One loud block among silent ones: its edge is to be no steeper than the way from centre to centre.
    const auto errors = [](int column, int row) {
        core::Block8x8 block{};
        block[1] = column == 2 && row == 1 ? 800.0f : 8.0f;
        return block;
    };
    const core::Plane<float> plane = distances(40, 40, errors);
    float steepest = 0;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x + 1 < 40; ++x) steepest = std::max(steepest, std::abs(plane.at(x + 1, y) - plane.at(x, y)));
    EXPECT_LE(steepest, (100.0f - 1.0f) / 8.0f * 1.001f);
    EXPECT_NEAR(*std::max_element(plane.values().begin(), plane.values().end()), 100.0f, 13.0f);
}

TEST(Tolerances, AreNeverBelowTwoPercentNorHalfACodeValue) {
    const Display display(0, ColorMatrix::bt709);
    const InverseLuma light(display);
    const PixelLight pixels = light_ramp(display, 64, 4);
    core::Plane<float> plane(64, 4, 1e-3f);
    to_tolerances(plane, pixels, light);
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const float luminance = pixels.luminance.values()[i];
        const float half = light.difference(pixels.luma.values()[i], luminance, pixels.exponent.values()[i], 0.5f);
        EXPECT_FLOAT_EQ(plane.values()[i], std::max(0.02f * luminance, half));
    }
}

TEST(Tolerances, AreWhatTheDisplayInvertsTo) {
    const Display display(0, ColorMatrix::bt709);
    const PixelLight pixels = light_ramp(display, 64, 1);
    core::Plane<float> plane(64, 1, 6.0f);
    to_tolerances(plane, pixels, InverseLuma(display));
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const float luma = pixels.luma.values()[i], luminance = pixels.luminance.values()[i];
        if (luma < 17.0f) continue;
        // Downward; what is nearer to black counts as so far from it.
        const float from = std::max(luma, 16.25f + 6.0f);
        const float light = core::luminance(display.with_luma(glm::vec3(luminance), from)),
                    distorted = core::luminance(display.with_luma(glm::vec3(luminance), from - 6.0f));
        const float exact = std::max(0.02f * luminance, light - distorted);
        EXPECT_NEAR(plane.values()[i], exact, 0.02f * exact) << luma;
    }
}

TEST(Blend, TakesHalfOfWhatWasCarriedWhereSomethingWas) {
    core::Plane<float> errors(3, 1, 4.0f), before(3, 1, 2.0f);
    before.at(1, 0) = -1.0f;
    before.at(2, 0) = 4.0f;
    blend(errors, before);
    EXPECT_FLOAT_EQ(errors.at(0, 0), 3.0f);
    EXPECT_FLOAT_EQ(errors.at(1, 0), 4.0f);
    EXPECT_FLOAT_EQ(errors.at(2, 0), 4.0f);
    blend(errors, {});
    EXPECT_FLOAT_EQ(errors.at(0, 0), 3.0f);
}

}  // namespace
}  // namespace render2mpeg::perceptual
