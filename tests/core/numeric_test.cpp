#include "core/numeric.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace render2mpeg::core {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float tiny = std::numeric_limits<float>::denorm_min();
constexpr float huge = std::numeric_limits<float>::max();

TEST(DivideOr, DividesWhereItCan) {
    EXPECT_EQ(divide_or(6.0f, -3.0f, 9.0f), -2.0f);
    EXPECT_EQ(divide_or(0.0f, -3.0f, 9.0f), 0.0f);
    EXPECT_EQ(divide_or(1.0, 8.0, 9.0), 0.125);
}

TEST(DivideOr, GivesTheOtherValueWhereThereIsNoFiniteQuotient) {
    for (const float b : {0.0f, -0.0f, tiny, nan}) EXPECT_EQ(divide_or(1.0f, b, 9.0f), 9.0f) << b;
    EXPECT_EQ(divide_or(huge, 0.5f, 9.0f), 9.0f);
    EXPECT_EQ(divide_or(inf, inf, 9.0f), 9.0f);
    EXPECT_EQ(divide_or(0.0f, 0.0f, 9.0f), 9.0f);
    EXPECT_EQ(divide_or(1.0, 0.0, 9.0), 9.0);
}

TEST(SqrtOrZero, TakesNoiseBelowZeroAsZero) {
    EXPECT_EQ(sqrt_or_zero(-1e-7f), 0.0f);
    EXPECT_EQ(sqrt_or_zero(nan), 0.0f);
    EXPECT_EQ(sqrt_or_zero(2.25f), 1.5f);
    EXPECT_EQ(sqrt_or_zero(-1e-16), 0.0);
    EXPECT_EQ(sqrt_or_zero(2.25), 1.5);
}

TEST(AcosClamped, StaysInItsDomain) {
    EXPECT_EQ(acos_clamped(1.0000001f), 0.0f);
    EXPECT_FLOAT_EQ(acos_clamped(-1.0000001f), std::numbers::pi_v<float>);
    EXPECT_FLOAT_EQ(acos_clamped(0.5f), std::numbers::pi_v<float> / 3);
}

TEST(NormalizeOr, MakesUnitVectorsAtEveryScale) {
    const glm::vec3 direction{1, -2, 2};  // length 3
    for (const float scale : {1e-37f, 1e-30f, 1e-10f, 1.0f, 1e10f, 1e30f, 1e38f}) {
        const glm::vec3 n = normalize_or(direction * scale, {0, 0, 1});
        EXPECT_NEAR(n.x, 1.0f / 3, 1e-6f) << scale;
        EXPECT_NEAR(n.y, -2.0f / 3, 1e-6f) << scale;
        EXPECT_NEAR(n.z, 2.0f / 3, 1e-6f) << scale;
    }
}

TEST(NormalizeOr, GivesTheOtherVectorWhereThereIsNoDirection) {
    const glm::vec3 up{0, 1, 0};
    EXPECT_EQ(normalize_or({0, 0, 0}, up), up);
    EXPECT_EQ(normalize_or({inf, 0, 0}, up), up);
    for (int i = 0; i < 3; ++i) {
        glm::vec3 v{1, 2, 3};
        v[i] = nan;
        EXPECT_EQ(normalize_or(v, up), up) << "component " << i;
    }
}

TEST(IsFinite, LooksAtEveryComponent) {
    EXPECT_TRUE(is_finite(glm::vec3(huge, 0, -huge)));
    for (int i = 0; i < 3; ++i)
        for (const float bad : {inf, -inf, nan}) {
            glm::vec3 v{1, 2, 3};
            v[i] = bad;
            EXPECT_FALSE(is_finite(v));
        }
    EXPECT_FALSE(is_finite(glm::vec2(0, nan)));
    glm::mat4 m(1.0f);
    EXPECT_TRUE(is_finite(m));
    m[3][2] = inf;
    EXPECT_FALSE(is_finite(m));
}

}  // namespace
}  // namespace render2mpeg::core
