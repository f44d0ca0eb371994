#include "core/color.h"

#include <gtest/gtest.h>

namespace render2mpeg::core {
namespace {

TEST(Luminance, OfWhiteIsOneAndIsLinear) {
    EXPECT_FLOAT_EQ(luminance({1, 1, 1}), 1.0f);
    const glm::vec3 c{0.2f, 0.5f, 0.9f};
    EXPECT_FLOAT_EQ(luminance(3.0f * c), 3.0f * luminance(c));
    EXPECT_GT(luminance({0, 1, 0}), luminance({1, 0, 0}));
    EXPECT_GT(luminance({1, 0, 0}), luminance({0, 0, 1}));
}

TEST(Srgb, HasItsPublishedValues) {
    // Code values 0, 10, 118, 188, 255 of IEC 61966-2-1's curve, computed in double precision.
    EXPECT_EQ(srgb_to_linear(0.0f), 0);
    EXPECT_NEAR(srgb_to_linear(10 / 255.0f), 0.0030352698, 1e-8);
    EXPECT_NEAR(srgb_to_linear(118 / 255.0f), 0.1811642442, 1e-6);
    EXPECT_NEAR(srgb_to_linear(188 / 255.0f), 0.5028864580, 1e-6);
    EXPECT_FLOAT_EQ(srgb_to_linear(1.0f), 1);
}

TEST(Srgb, IsUndoneByItsInverseAndRises) {
    float before = -1;
    for (int i = 0; i <= 1000; ++i) {
        const float v = static_cast<float>(i) / 1000;
        const float linear = srgb_to_linear(v);
        EXPECT_GT(linear, before);
        EXPECT_NEAR(linear_to_srgb(linear), v, 2e-6f);
        before = linear;
    }
}

TEST(Srgb, IsContinuousWhereItsTwoPiecesMeet) {
    EXPECT_NEAR(srgb_to_linear(0.04045f), srgb_to_linear(std::nextafter(0.04045f, 1.0f)), 1e-7f);
    EXPECT_NEAR(linear_to_srgb(0.0031308f), linear_to_srgb(std::nextafter(0.0031308f, 1.0f)), 1e-6f);
}

}  // namespace
}  // namespace render2mpeg::core
