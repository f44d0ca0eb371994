#include "renderer/lights/emission_guide.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

glm::vec3 numbers_of(std::uint64_t i) {
    return {core::halton(0, i), core::halton(1, i), core::halton(2, i)};
}

/// What a path leaves: much from one window of the cube, a little from elsewhere.
float value_at(glm::vec3 n) {
    const bool window = n.x > 0.5f && n.y > 0.25f && n.y < 0.375f && n.z > 0.75f;
    return window ? 1.0f : 0.01f;
}

EmissionGuide learnt(std::uint64_t paths) {
    std::vector<GuidedPath> useful;
    for (std::uint64_t i = 1; i <= paths; ++i) useful.push_back({numbers_of(i), value_at(numbers_of(i))});
    return EmissionGuide(std::move(useful), paths);
}

TEST(EmissionGuide, WithoutPathsChangesNothing) {
    for (const EmissionGuide& guide :
         {EmissionGuide(), EmissionGuide({}, 0), EmissionGuide({}, 100), EmissionGuide({{glm::vec3(0.5f), 0.0f}}, 1)}) {
        const auto [numbers, density] = guide.start({0.1f, 0.7f, 0.3f});
        EXPECT_EQ(numbers, glm::vec3(0.1f, 0.7f, 0.3f));
        EXPECT_EQ(density, 1.0f);
    }
}

TEST(EmissionGuide, KeepsTheMeanAndLowersTheVariance) {
    const EmissionGuide guide = learnt(20000);
    double truth = 0, squares = 0, mean = 0, guided = 0, whole = 0;
    constexpr std::uint64_t count = 20000;
    for (std::uint64_t i = 1; i <= count; ++i) {
        const glm::vec3 even = numbers_of(100000 + i);
        const double plain = value_at(even);
        const auto [numbers, density] = guide.start(even);
        ASSERT_GT(density, 0.99f * static_cast<float>(EmissionGuide::even_share));
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(numbers[k] >= 0.0f && numbers[k] < 1.0f);
        const double weighted = static_cast<double>(value_at(numbers)) / density;
        truth += plain / count;
        squares += plain * plain / count;
        mean += weighted / count;
        guided += weighted * weighted / count;
        whole += 1.0 / density / count;
    }
    EXPECT_NEAR(mean, truth, 0.01 * truth);
    EXPECT_NEAR(whole, 1.0, 0.02);  // the density's integral over what is chosen
    EXPECT_LT(guided - mean * mean, 0.2 * (squares - truth * truth));
}

TEST(EmissionGuide, LooksAtEveryPartOfTheCube) {
    const EmissionGuide guide = learnt(20000);
    int outside = 0;
    for (std::uint64_t i = 1; i <= 1000; ++i) outside += value_at(guide.start(numbers_of(i)).numbers) < 0.5f ? 1 : 0;
    EXPECT_GT(outside, 150);
    EXPECT_LT(outside, 700);
}

TEST(EmissionGuide, IsAFunctionOfItsPaths) {
    const EmissionGuide a = learnt(3000), b = learnt(3000);
    for (std::uint64_t i = 1; i <= 100; ++i) EXPECT_EQ(a.start(numbers_of(i)).numbers, b.start(numbers_of(i)).numbers);
}

}  // namespace
}  // namespace render2mpeg::renderer
