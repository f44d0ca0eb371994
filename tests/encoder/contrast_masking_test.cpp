#include "encoder/contrast_masking.h"

#include <gtest/gtest.h>

#include <cmath>

/// Quantisers by contrast.
namespace render2mpeg::test {
namespace {

/// Left of `edge` all the same, right of it a checkerboard.
core::Plane<std::uint8_t> half_textured(int width, int height, int edge) {
    core::Plane<std::uint8_t> luma(width, height, 100);
    for (int y = 0; y < height; ++y)
        for (int x = edge; x < width; ++x) luma.at(x, y) = (x + y) % 2 == 0 ? 40 : 160;
    return luma;
}

TEST(ContrastFactors, AreFinerWhereLumaIsSmoothAndOneInTheMean) {
    const core::Plane<float> factors = encoder::contrast_factors(half_textured(70, 40, 32));
    ASSERT_EQ(factors.width(), 5);
    ASSERT_EQ(factors.height(), 3);
    double logarithms = 0;
    for (const float factor : factors.values()) logarithms += std::log(static_cast<double>(factor));
    EXPECT_NEAR(logarithms, 0, 1e-5);
    EXPECT_LT(factors.at(0, 1), 0.8f);
    EXPECT_GT(factors.at(3, 1), 1.2f);
    EXPECT_NEAR(factors.at(4, 2), factors.at(3, 0), 1e-5f) << "what hangs over the picture does not count";
}

TEST(ContrastFactors, TakeAMacroblockWithASmoothPartForSmootherThanOneWithout) {
    const core::Plane<float> factors = encoder::contrast_factors(half_textured(48, 16, 24));
    EXPECT_LT(factors.at(0, 0), factors.at(1, 0));
    EXPECT_LT(factors.at(1, 0), factors.at(2, 0));
}

TEST(ContrastFactors, ChangeNothingInAPictureOfOneColour) {
    const core::Plane<float> factors = encoder::contrast_factors(core::Plane<std::uint8_t>(33, 17, 16));
    for (const float factor : factors.values()) EXPECT_FLOAT_EQ(factor, 1.0f);
}

}  // namespace
}  // namespace render2mpeg::test
