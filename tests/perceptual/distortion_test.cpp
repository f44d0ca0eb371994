#include "perceptual/distortion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/sampling.h"
#include "tests/perceptual/mpeg2_quantisation.h"

namespace render2mpeg::perceptual {
namespace {

/// [H262, 6.3.11], written down a second time.
constexpr double intra_weights[64] = {8,  16, 19, 22, 26, 27, 29, 34, 16, 16, 22, 24, 27, 29, 34, 37,
                                      19, 22, 26, 27, 29, 34, 34, 38, 22, 22, 26, 27, 29, 34, 37, 40,
                                      22, 26, 27, 29, 32, 35, 40, 48, 26, 27, 29, 32, 35, 40, 48, 58,
                                      26, 27, 29, 34, 38, 46, 56, 69, 27, 29, 35, 38, 46, 56, 69, 83};

core::Block8x8 random_block(std::uint64_t seed, float reach) {
    core::Block8x8 block;
    for (std::size_t i = 0; i < 64; ++i) block[i] = reach * (2.0f * core::uniform(seed, i) - 1.0f);
    block[0] = 8.0f * (16.0f + 219.0f * core::uniform(seed, 64));
    return block;
}

core::Block8x8 random_thresholds(std::uint64_t seed) {
    core::Block8x8 m;
    for (std::size_t i = 0; i < 64; ++i)
        m[i] = static_cast<float>(intra_weights[i]) * (0.2f + 3.0f * core::uniform(seed, i, 1));
    return m;
}

/// The steps of MPEG-2 at these codes, in coefficients: what an encoder can do at worst.
constexpr int codes[] = {1, 2, 4, 8, 16, 24, 31};

TEST(WorstErrors, OfIntraBlocksAreThoseOfTheFormulaInDoublePrecision) {
    for (const int code : codes)
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            const double qs = code / 8.0;
            const core::Block8x8 c = random_block(seed, 120.0f), m = random_thresholds(seed);
            const core::Block8x8 errors = worst_errors(c, m, default_quantisation(), {code / 8.0f, true, nullptr});
            EXPECT_FLOAT_EQ(errors[0], 4.0f);
            for (std::size_t i = 1; i < 64; ++i) {
                const double c_i = c[i];
                const double size =
                    std::abs(c_i) < intra_weights[i] * qs / 2 ? qs * 16 / 2 : qs * static_cast<double>(m[i]) / 2;
                EXPECT_NEAR(errors[i], c_i < 0 ? -size : size, 1e-5 * size) << code << " " << i;
            }
        }
}

TEST(WorstErrors, OfCoefficientsThatVanishNeverExceedHalfTheirStep) {
    core::Block8x8 c{};
    c[0] = 1000;
    const core::Block8x8 m = random_thresholds(3);
    for (const int code : codes) {
        const auto scale = static_cast<float>(code) / 8.0f;
        const core::Block8x8 errors = worst_errors(c, m, default_quantisation(), {scale, true, nullptr});
        for (std::size_t i = 1; i < 64; ++i) {
            EXPECT_GT(errors[i], 0.0f) << "0 counts as positive";
            EXPECT_LE(errors[i], 0.5f * scale * static_cast<float>(intra_weights[i]) * 1.000001f);
        }
    }
}

TEST(WorstErrors, OfPredictedBlocksAreDecidedByTheResidual) {
    const core::Block8x8 c = random_block(5, 200.0f), m = random_thresholds(5);
    core::Block8x8 residual{};
    residual[9] = -15.9f;  // flat matrix at scale 1: a dead zone of 16
    residual[10] = -16.1f;
    const core::Block8x8 errors = worst_errors(c, m, default_quantisation(), {1.0f, false, &residual});
    for (std::size_t i = 1; i < 64; ++i) {
        const double masked = 8.0 * static_cast<double>(m[i]) / intra_weights[i];
        EXPECT_NEAR(std::abs(errors[i]), i == 10 ? masked : 8.0, 1e-4) << i;
        EXPECT_EQ(std::signbit(errors[i]), std::signbit(c[i])) << "the sign is the block's, not the residual's";
    }
}

TEST(WorstErrors, OfAnUnknownResidualAreThoseOfNone) {
    const core::Block8x8 c = random_block(6, 200.0f), m = random_thresholds(6), none{};
    EXPECT_EQ(worst_errors(c, m, default_quantisation(), {2.0f, false, nullptr}),
              worst_errors(c, m, default_quantisation(), {2.0f, false, &none}));
}

TEST(WorstErrors, OfTheMeanDoNotGrowWithTheScale) {
    const core::Block8x8 c = random_block(7, 50.0f), m = random_thresholds(7);
    for (const float dc_step : {8.0f, 4.0f, 2.0f})
        for (const int code : codes) {
            Quantisation quantisation = default_quantisation();
            quantisation.dc_step = dc_step;
            const auto scale = static_cast<float>(code) / 8.0f;
            EXPECT_FLOAT_EQ(worst_errors(c, m, quantisation, {scale, true, nullptr})[0], dc_step / 2);
            const float inter = worst_errors(c, m, quantisation, {scale, false, nullptr})[0];
            EXPECT_FLOAT_EQ(inter, std::min(8.0f * scale, dc_step / 2));
        }
}

TEST(ShareOfMean, FallsAsTheScaleRises) {
    // 63 coefficients of size 8 s and a mean of at most half of the step of 8.
    for (const bool intra : {true, false})
        for (const float scale : {0.25f, 0.5f, 1.0f, 2.0f, 4.0f}) {
            const float mean = intra ? 4.0f : std::min(8.0f * scale, 4.0f),
                        all = std::sqrt((63 * 64 * scale * scale + mean * mean) / 64);
            EXPECT_FLOAT_EQ(share_of_mean(default_quantisation(), {scale, intra, nullptr}), std::min(mean / all, 1.0f));
        }
}

TEST(WorstErrors, FollowTheEncodersMatrices) {
    const core::Block8x8 c = random_block(8, 400.0f), m = random_thresholds(8);
    Quantisation twice = default_quantisation();
    for (std::size_t i = 0; i < 64; ++i) twice.intra[i] *= 2, twice.inter[i] *= 2;
    for (const bool intra : {true, false}) {
        const core::Block8x8 a = worst_errors(c, m, twice, {0.5f, intra, nullptr}),
                             b = worst_errors(c, m, default_quantisation(), {1.0f, intra, nullptr});
        for (std::size_t i = 0; i < 64; ++i) EXPECT_FLOAT_EQ(a[i], b[i]);
    }
}

TEST(RootMeanSquare, OfErrorsIsThatOfTheirSamples) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const core::Block8x8 errors = random_block(seed, 30.0f);
        double sum = 0;
        for (const float sample : core::inverse_dct(errors)) sum += static_cast<double>(sample) * sample;
        EXPECT_NEAR(root_mean_square(errors), std::sqrt(sum / 64), 1e-5 * std::sqrt(sum / 64));
    }
}

}  // namespace
}  // namespace render2mpeg::perceptual
