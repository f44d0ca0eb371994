#include "core/dct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/sampling.h"

namespace render2mpeg::core {
namespace {

/// The definition, in double precision and as slow as it stands in the books. [H262, annex A]
Block8x8 slow_forward(const Block8x8& samples) {
    Block8x8 result{};
    for (int v = 0; v < 8; ++v)
        for (int u = 0; u < 8; ++u) {
            double sum = 0;
            for (int y = 0; y < 8; ++y)
                for (int x = 0; x < 8; ++x)
                    sum += samples[y * 8 + x] * std::cos((2 * x + 1) * u * std::numbers::pi / 16) *
                           std::cos((2 * y + 1) * v * std::numbers::pi / 16);
            const double cu = u == 0 ? std::numbers::sqrt2 / 2 : 1;
            const double cv = v == 0 ? std::numbers::sqrt2 / 2 : 1;
            result[v * 8 + u] = static_cast<float>(0.25 * cu * cv * sum);
        }
    return result;
}

Block8x8 noise(std::uint64_t seed) {
    Block8x8 block;
    for (int i = 0; i < 64; ++i) block[i] = 16 + 219 * uniform(seed, static_cast<std::uint64_t>(i));
    return block;
}

TEST(Dct, EqualsItsDefinition) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const Block8x8 fast = forward_dct(noise(seed));
        const Block8x8 slow = slow_forward(noise(seed));
        for (int i = 0; i < 64; ++i) EXPECT_NEAR(fast[i], slow[i], 1e-3f) << "coefficient " << i;
    }
}

TEST(Dct, IsUndoneByItsInverse) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const Block8x8 samples = noise(seed);
        const Block8x8 back = inverse_dct(forward_dct(samples));
        for (int i = 0; i < 64; ++i) EXPECT_NEAR(back[i], samples[i], 1e-3f);
    }
}

TEST(Dct, CoefficientZeroIsEightTimesTheMean) {
    const Block8x8 samples = noise(3);
    const float mean = std::accumulate(samples.begin(), samples.end(), 0.0f) / 64;
    EXPECT_NEAR(forward_dct(samples)[0], 8 * mean, 1e-3f);

    Block8x8 flat;
    flat.fill(100);
    const Block8x8 coefficients = forward_dct(flat);
    EXPECT_NEAR(coefficients[0], 800, 1e-3f);
    for (int i = 1; i < 64; ++i) EXPECT_NEAR(coefficients[i], 0, 1e-4f);
}

TEST(Dct, KeepsEnergy) {
    const Block8x8 samples = noise(4);
    const Block8x8 coefficients = forward_dct(samples);
    double before = 0, after = 0;
    for (int i = 0; i < 64; ++i) {
        before += double{samples[i]} * samples[i];
        after += double{coefficients[i]} * coefficients[i];
    }
    EXPECT_NEAR(after / before, 1, 1e-6);
}

TEST(Dct, CountsHorizontalFrequencyAlongTheRow) {
    Block8x8 samples;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            samples[y * 8 + x] = static_cast<float>(std::cos((2 * x + 1) * 3 * std::numbers::pi / 16));
    const Block8x8 coefficients = forward_dct(samples);
    for (int i = 0; i < 64; ++i) EXPECT_NEAR(coefficients[i], i == 3 ? std::sqrt(32.0f) : 0, 1e-5f) << i;
}

}  // namespace
}  // namespace render2mpeg::core
