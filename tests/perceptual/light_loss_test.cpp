#include "perceptual/light_loss.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/picture.h"
#include "core/sampling.h"
#include "perceptual/masking.h"

namespace render2mpeg::perceptual {
namespace {

constexpr float step = 16;

/// Steps that are alike in all coefficients, rounded to the nearest level.
Quantisation even_steps() {
    Quantisation quantisation;
    quantisation.intra.fill(step);
    quantisation.inter.fill(step);
    quantisation.dc_step = step;
    return quantisation;
}

core::Plane<BlockNoise> white_noise(int width, int height, float variance) {
    BlockNoise noise;
    noise.fill(variance);
    return core::Plane<BlockNoise>(width, height, noise);
}

/// Blocks whose coefficients lie anywhere between two levels.
core::Plane<core::Block8x8> busy_blocks(int width, int height) {
    core::Plane<core::Block8x8> blocks(width, height);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (std::size_t i = 0; i < 64; ++i) blocks.values()[b][i] = 100 * step * core::uniform(7, b, i);
    return blocks;
}

/// Blocks that nothing predicts.
CodedBlocks alone(const core::Plane<core::Block8x8>& blocks) {
    return {blocks, {}, {}};
}

TEST(LightLoss, OfBusyBlocksIsAllOfTheirNoise) {
    const core::Plane<core::Block8x8> blocks = busy_blocks(40, 30);
    for (const float variance : {2.0f, 20.0f}) {
        const NoisyPicture picture{alone(blocks), white_noise(40, 30, variance), even_steps(), 1};
        // Rounding to levels leaves a twelfth of the step's square, whatever the noise.
        const double expected = 10 * std::log10(1 + variance / (step * step / 12.0));
        EXPECT_NEAR(picture.loss(1) / expected, 1, 0.05) << variance;
        EXPECT_NEAR(picture.loss(2), 10 * std::log10(1 + 4 * variance / (step * step / 12.0)), 0.05 * expected * 4);
        EXPECT_EQ(picture.loss(0), 0);
    }
}

TEST(LightLoss, OfWhatVanishesIsNothingUntilNoiseReachesALevel) {
    core::Block8x8 faint;
    faint.fill(0.5f);
    const core::Plane<core::Block8x8> blocks(40, 30, faint);
    const NoisyPicture picture{alone(blocks), white_noise(40, 30, 1.0f), even_steps(), 1};
    EXPECT_EQ(picture.loss(1), 0);
    EXPECT_GT(picture.loss(8), 10);
}

TEST(LightLoss, OfWhatIsPredictedVanishesWithTheRest) {
    // Stripes that no step hides, and a prediction of all but the last block.
    core::Picture picture;
    picture.y = core::Plane<std::uint8_t>(64, 8);
    picture.luma = core::Plane<float>(64, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 64; ++x) picture.luma.at(x, y) = x % 2 == 0 ? 53.0f : 180.0f;
    const core::Plane<core::Block8x8> blocks = transform(picture);
    core::Plane<float> prediction = picture.luma;
    const auto loss = [&](const core::Plane<float>& by) {
        Quantisation quantisation = even_steps();
        quantisation.inter_dead_zone = 1;
        return NoisyPicture{{blocks, picture.luma, by}, white_noise(8, 1, 4), quantisation, 1}.loss(1);
    };
    EXPECT_GT(loss({}), 0.1);
    EXPECT_EQ(loss(prediction), 0);
    prediction.at(60, 4) = -1;
    const CodedBlocks coded(blocks, picture.luma, prediction);
    EXPECT_EQ(coded.predicted.at(6, 0), 1);
    EXPECT_EQ(coded.predicted.at(7, 0), 0);
    EXPECT_EQ(coded.coefficients.at(7, 0), blocks.at(7, 0));
    EXPECT_GT(loss(prediction), 0);
}

TEST(LightLoss, OfWhatStepsLeftIsLessThanOfThePicture) {
    const core::Plane<core::Block8x8> blocks = busy_blocks(40, 30);
    Quantisation quantisation = even_steps();
    const CodedBlocks left = left_by_intra(blocks, quantisation, 1);
    for (const core::Block8x8& block : left.coefficients.values())
        for (const float c : block) ASSERT_LE(std::abs(c), 0.5f * step + 1e-3f);
    quantisation.inter_dead_zone = 1;
    const auto loss = [&](const CodedBlocks& coded) {
        return NoisyPicture{coded, white_noise(40, 30, 4), quantisation, 1}.loss(1);
    };
    EXPECT_LT(loss(left), 0.1 * loss(alone(blocks)));
}

TEST(LightLoss, DecodedPicturesAreOffByWhatTheirStepsLeave) {
    // A ramp in noise, and a prediction of all but the last block that is 3 code values too bright.
    core::Picture picture;
    picture.y = core::Plane<std::uint8_t>(60, 12);
    picture.luma = core::Plane<float>(60, 12);
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 60; ++x)
            picture.luma.at(x, y) = 60.0f + 2.0f * static_cast<float>(x) + 20.0f * core::uniform(3, x, y);
    core::Plane<float> prediction = picture.luma;
    for (float& value : prediction.values()) value += 3;
    prediction.at(58, 10) = -1;
    const core::Plane<core::Block8x8> blocks = transform(picture);
    const auto off = [&](const core::Plane<float>& by, float scale, int first, int last) {
        const CodedBlocks coded(blocks, picture.luma, by);
        Quantisation quantisation = even_steps();
        quantisation.dc_step *= scale;
        const core::Plane<std::uint8_t> seen = decode(coded, picture.luma, by, quantisation, scale);
        double square = 0;
        for (int y = 0; y < 8; ++y)
            for (int x = first; x < last; ++x) {
                const double d = static_cast<double>(seen.at(x, y)) - static_cast<double>(picture.luma.at(x, y));
                square += d * d / (8.0 * (last - first));
            }
        return square;
    };
    // Next to no steps leave the rounding of a decoder; coarse ones up to a twelfth of their squares, less of what
    // vanishes.
    EXPECT_NEAR(off({}, 1.0f / 64, 0, 56), 1.0 / 12, 0.02);
    EXPECT_NEAR(off({}, 1, 0, 56), step * step / 12, 0.3 * step * step / 12);
    // Of what is predicted a difference of one step and a half is told to half a step, one below half a step not at
    // all.
    EXPECT_NEAR(off(prediction, 1, 0, 56), 1.0, 0.2);
    EXPECT_NEAR(off(prediction, 4, 0, 56), 9.0, 0.5);
    const CodedBlocks coded(blocks, picture.luma, prediction);
    EXPECT_EQ(coded.predicted.at(7, 1), 0);
    EXPECT_EQ(decode(coded, picture.luma, prediction, even_steps(), 1).at(58, 10),
              decode(alone(blocks), picture.luma, {}, even_steps(), 1).at(58, 10));
}

TEST(LightLoss, OfABlackPictureIsOverItsRounding) {
    const core::Plane<core::Block8x8> black(40, 30, core::Block8x8{});
    EXPECT_EQ((NoisyPicture{alone(black), white_noise(40, 30, 0), even_steps(), 1}.loss(8)), 0);
    Quantisation fine = even_steps();
    fine.intra.fill(0.01f);
    fine.dc_step = 0.01f;
    EXPECT_NEAR((NoisyPicture{alone(black), white_noise(40, 30, 0.25f), fine, 1}.loss(1)),
                10 * std::log10(1 + 0.25 * 12), 0.1);
}

TEST(LightLoss, NumberOfALossIsWhereItIs) {
    const core::Plane<core::Block8x8> blocks = busy_blocks(40, 30);
    const NoisyPicture picture{alone(blocks), white_noise(40, 30, 3.0f), even_steps(), 1};
    const auto loss = [&](double times) { return picture.loss(times); };
    EXPECT_NEAR(picture.loss(number_of_loss(0.3, 0.1, 10, loss)), 0.3, 0.02);
    // Out of reach, it is an end.
    EXPECT_NEAR(number_of_loss(90, 0.1, 10, loss), 10, 0.1);
    EXPECT_NEAR(number_of_loss(1e-9, 0.1, 10, loss), 0.1, 0.001);
}

TEST(LightLoss, BlocksKeepTheEnergyOfTheirPixels) {
    const auto energy = [](const BlockNoise& noise) {
        double sum = 0;
        for (const float variance : noise) sum += static_cast<double>(variance);
        return sum / 64;
    };
    // White noise has a 64th of its variance in the mean; records of the widest planes 0.29.
    for (const float of_block : {1.0f / 64, 0.1f, 0.28f}) {
        const core::Plane<BlockNoise> noise =
            noise_of_blocks(core::Plane<PixelNoise>(19, 9, {5.0f, 5.0f * of_block}), core::Plane<float>(19, 9, 235.0f));
        ASSERT_EQ(noise.width(), 3);
        ASSERT_EQ(noise.height(), 2);
        for (const BlockNoise& block : noise.values()) {
            EXPECT_NEAR(energy(block), 5, 1e-2);
            EXPECT_NEAR(block[0] / 64, 5 * of_block, 1e-3);
        }
    }
    const BlockNoise white =
        noise_of_blocks(core::Plane<PixelNoise>(8, 8, {5.0f, 5.0f / 64}), core::Plane<float>(8, 8, 235.0f)).at(0, 0);
    for (const float variance : white) EXPECT_NEAR(variance, 5, 1e-2);
}

TEST(LightLoss, NoiseIsAsADisplayShowsIt) {
    // Light of luma 36 with errors of so many times itself, normally distributed.
    constexpr double luma = 36, above = luma - 16, power = 2.2;
    for (const double error : {0.05, 0.3, 1.0, 20.0, 500.0}) {
        double expected = 0, sum = 0;
        for (double z = -6; z <= 6; z += 0.001) {
            const double density = std::exp(-0.5 * z * z),
                         off = above * (std::pow(std::max(1 + error * z, 0.0), 1 / power) - 1);
            expected += density * off * off;
            sum += density;
        }
        const auto variance = static_cast<float>(std::pow(error * above / power, 2));
        const BlockNoise block = noise_of_blocks(core::Plane<PixelNoise>(8, 8, {variance, variance / 64}),
                                                 core::Plane<float>(8, 8, static_cast<float>(luma)))
                                     .at(0, 0);
        EXPECT_NEAR(static_cast<double>(block[0]) / (expected / sum), 1, 0.25) << error;
    }
}

}  // namespace
}  // namespace render2mpeg::perceptual
