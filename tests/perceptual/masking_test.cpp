#include "perceptual/masking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/sampling.h"

namespace render2mpeg::perceptual {
namespace {

/// [H262, 6.3.11], written down a second time.
constexpr int intra_matrix[8][8] = {
    {8, 16, 19, 22, 26, 27, 29, 34},  {16, 16, 22, 24, 27, 29, 34, 37}, {19, 22, 26, 27, 29, 34, 34, 38},
    {22, 22, 26, 27, 29, 34, 37, 40}, {22, 26, 27, 29, 32, 35, 40, 48}, {26, 27, 29, 32, 35, 40, 48, 58},
    {26, 27, 29, 34, 38, 46, 56, 69}, {27, 29, 35, 38, 46, 56, 69, 83},
};

core::Picture picture_of(core::Plane<float> luma) {
    core::Picture picture;
    picture.number = 7;
    picture.y = core::Plane<std::uint8_t>(luma.width(), luma.height());
    for (std::size_t i = 0; i < luma.size(); ++i)
        picture.y.values()[i] = static_cast<std::uint8_t>(luma.values()[i] + 0.5f);
    picture.luma = std::move(luma);
    return picture;
}

/// Dark to bright from left to right, smooth above and noisy below.
core::Picture busy_picture(int width, int height) {
    core::Plane<float> luma(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float along = static_cast<float>(x) / static_cast<float>(std::max(1, width - 1));
            const float rough = y < height / 2 ? 0.5f : 60.0f;
            const float noise = core::uniform(3, static_cast<std::uint64_t>(y * width + x)) - 0.5f;
            luma.at(x, y) = std::clamp(16.0f + 219.0f * along * along + rough * noise, 16.0f, 235.0f);
        }
    return picture_of(std::move(luma));
}

/// [Render2MPEG, eq. 7.1 and 7.2] word by word, in double precision, with the DCT by its definition.
struct SlowThresholds {
    int columns, rows;
    std::vector<double> value;

    explicit SlowThresholds(const core::Picture& p) : columns((p.width() + 7) / 8), rows((p.height() + 7) / 8) {
        std::vector<double> coefficients;
        double mean = 0;
        for (int k = 0; k < columns * rows; ++k)
            for (int v = 0; v < 8; ++v)
                for (int u = 0; u < 8; ++u) coefficients.push_back(coefficient(p, k % columns, k / columns, u, v));
        const auto bright = [&](int k) { return std::max(8.0, coefficients[static_cast<std::size_t>(64 * k)] - 128); };
        for (int k = 0; k < columns * rows; ++k) mean += bright(k) / (columns * rows);
        for (int k = 0; k < columns * rows; ++k)
            for (int i = 0; i < 64; ++i) {
                const double t = intra_matrix[i / 8][i % 8] * std::pow(bright(k) / mean, 2.2 * 0.649);
                const double c = coefficients[static_cast<std::size_t>(64 * k + i)];
                value.push_back(i == 0 ? t : t * std::max(1.0, std::pow(std::abs(c / t), 0.7)));
            }
    }

    static double coefficient(const core::Picture& p, int column, int row, int u, int v) {
        const auto scale = [](int f) { return std::sqrt(f == 0 ? 0.125 : 0.25); };
        double sum = 0;
        for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 8; ++i) {
                const int x = std::min(8 * column + i, p.width() - 1), y = std::min(8 * row + j, p.height() - 1);
                const double sample = p.luma.empty() ? p.y.at(x, y) : static_cast<double>(p.luma.at(x, y));
                sum += sample * std::cos((2 * i + 1) * u * std::numbers::pi / 16) *
                       std::cos((2 * j + 1) * v * std::numbers::pi / 16);
            }
        return scale(u) * scale(v) * sum;
    }
};

void expect_equal_to_reference(const core::Picture& picture) {
    const ThresholdMap map = mask(picture);
    const SlowThresholds slow(picture);
    EXPECT_EQ(map.picture, picture.number);
    ASSERT_EQ(map.blocks.width(), slow.columns);
    ASSERT_EQ(map.blocks.height(), slow.rows);
    double worst = 0;
    for (std::size_t k = 0; k < map.blocks.size(); ++k)
        for (std::size_t i = 0; i < 64; ++i) {
            const double expected = slow.value[64 * k + i];
            worst = std::max(worst, std::abs(static_cast<double>(map.blocks.values()[k][i]) - expected) / expected);
        }
    // Single precision loses most where luma is next to black: 128 is taken from a coefficient of 136.
    EXPECT_LT(worst, 1e-4);
}

TEST(Masking, EqualsTheFormulasInDoublePrecision) {
    for (const auto& [width, height] : {std::pair{64, 48}, {45, 31}, {3, 5}, {1, 1}}) {
        core::Picture picture = busy_picture(width, height);
        expect_equal_to_reference(picture);
        picture.luma = {};
        expect_equal_to_reference(picture);
    }
}

TEST(Masking, EqualsThemForContrastsOfAllSizes) {
    // Blocks with a single frequency, from 1 / 1000 of a code value to all that fits.
    core::Plane<float> luma(256, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 256; ++x) {
            const double strength = 0.001 * std::pow(10.0, 5.0 * (x / 8) / 31.0);
            const int u = (y / 8) % 8, v = (x / 8) % 8;
            luma.at(x, y) =
                static_cast<float>(125.0 + strength * std::cos((2 * (x % 8) + 1) * u * std::numbers::pi / 16) *
                                               std::cos((2 * (y % 8) + 1) * v * std::numbers::pi / 16));
        }
    expect_equal_to_reference(picture_of(std::move(luma)));
}

TEST(Masking, AFlatPictureHasTheMatrixItself) {
    for (const float level : {0.0f, 16.0f, 17.0f, 90.0f, 235.0f}) {
        const ThresholdMap map = mask(picture_of(core::Plane<float>(24, 16, level)));
        for (const core::Block8x8& block : map.blocks.values())
            for (std::size_t i = 0; i < 64; ++i)
                EXPECT_NEAR(block[i], intra_matrix[i / 8][i % 8], 1e-3) << "level " << level;
    }
}

TEST(Masking, BrightBlocksHideMoreAndBlackOnesStillHideSomething) {
    core::Plane<float> luma(24, 8, 16.0f);
    for (int y = 0; y < 8; ++y)
        for (int x = 8; x < 24; ++x) luma.at(x, y) = x < 16 ? 66.0f : 116.0f;
    const ThresholdMap map = mask(picture_of(std::move(luma)));
    const float black = map.blocks.at(0, 0)[9], grey = map.blocks.at(1, 0)[9], bright = map.blocks.at(2, 0)[9];
    EXPECT_GT(black, 0.0f);
    EXPECT_NEAR(bright / grey, std::pow(2.0, 2.2 * 0.649), 1e-4) << "50 and 100 above black";
    EXPECT_NEAR(grey / black, std::pow(50.0, 2.2 * 0.649), 0.01) << "black counts as one code value above it";
}

TEST(Masking, ContrastRaisesOnlyItsOwnFrequency) {
    core::Plane<float> luma(8, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            luma.at(x, y) = static_cast<float>(120.0 + 40.0 * std::cos((2 * x + 1) * 3 * std::numbers::pi / 16));
    const core::Block8x8 block = mask(picture_of(std::move(luma))).blocks.at(0, 0);
    for (std::size_t i = 0; i < 64; ++i) {
        const double q = intra_matrix[i / 8][i % 8];
        // The coefficient is 40 sqrt(8 / 2) sqrt(8).
        const double expected = i == 3 ? q * std::pow(40.0 * 2.0 * std::sqrt(8.0) / q, 0.7) : q;
        EXPECT_NEAR(block[i], expected, 1e-3 * expected);
    }
}

/// Grey, and from column `edge` on `contrast` times the threshold, an eighth of 26, of the coefficient (0, 4), in whose
/// pattern luma is above and below by an eighth of the coefficient.
core::Picture striped(int width, int height, int edge, float contrast) {
    core::Plane<float> luma(width, height, 120.0f);
    for (int y = 0; y < height; ++y)
        for (int x = edge; x < width; ++x)
            luma.at(x, y) += (x % 4 == 0 || x % 4 == 3 ? 1.0f : -1.0f) * contrast * 26.0f / 64.0f;
    return picture_of(std::move(luma));
}

TEST(Hidden, IsNothingWhereLumaIsFlatHoweverBright) {
    for (const float grey : {16.0f, 70.0f, 235.0f}) {
        const core::Plane<float> octaves = hidden(picture_of(core::Plane<float>(40, 24, grey)));
        for (const float here : octaves.values()) EXPECT_EQ(here, 0.0f) << grey;
    }
}

TEST(Hidden, IsByHowMuchContrastRaisesThresholds) {
    EXPECT_NEAR(hidden(striped(16, 16, 0, 0.9f)).at(0, 0), 0.0f, 1e-4f) << "contrast that is not seen hides nothing";
    const double expected = 0.7 * std::log2(10.0) / 63;
    EXPECT_NEAR(hidden(striped(16, 16, 0, 10.0f)).at(0, 0), expected, 1e-4);
}

TEST(Hidden, OfNoiseGrowsWithItsDeviation) {
    const auto noise = [](float deviation) {
        core::Picture picture = picture_of(core::Plane<float>(64, 64, 120.0f));
        for (std::size_t i = 0; i < picture.luma.size(); ++i)
            picture.luma.values()[i] += deviation * std::sqrt(12.0f) * (core::uniform(5, i) - 0.5f);
        return picture;
    };
    const core::Plane<float> once = hidden(noise(20000)), twice = hidden(noise(40000));
    for (std::size_t i = 0; i < once.size(); ++i)
        EXPECT_NEAR(twice.values()[i] - once.values()[i], 0.7, 0.01) << "[Render2MPEG, eq. 7.2]";
}

TEST(Hidden, OfAMacroblockIsTheMeanOfItsBlocksWithinThePicture) {
    const core::Plane<float> octaves = hidden(striped(56, 24, 24, 10.0f));
    ASSERT_EQ(octaves.width(), 4);
    ASSERT_EQ(octaves.height(), 2);
    EXPECT_NEAR(octaves.at(0, 0), 0.0f, 1e-5f);
    EXPECT_NEAR(octaves.at(1, 0), 0.5f * octaves.at(2, 0), 1e-4f) << "half of it is flat";
    EXPECT_NEAR(octaves.at(3, 1), octaves.at(2, 0), 1e-4f) << "padding does not count";
}

TEST(Masking, APictureWithoutPixelsHasNoBlocks) {
    EXPECT_TRUE(mask(core::Picture{}).blocks.empty());
}

TEST(Masking, LumaThatIsNoNumberIsABrokenContract) {
    core::Picture picture = busy_picture(16, 16);
    picture.luma.at(9, 3) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(mask(picture), core::ContractViolation);
}

}  // namespace
}  // namespace render2mpeg::perceptual
