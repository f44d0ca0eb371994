#include "encoder/mpeg2/macroblock/weighting_matrices.h"

#include <gtest/gtest.h>

#include <cmath>

#include "encoder/mpeg2/bitstream/tuning.h"
#include "film.h"

namespace render2mpeg::encoder::testing {
namespace {

Settings perceptual(int width, int height, int quantiser, int gop, int b_pictures) {
    Settings s = settings(width, height, quantiser, gop, 3, b_pictures);
    s.tune = Tune::perceptual;
    return s;
}

TEST(WeightingMatrices, FilmsWithTheEyesMatricesAreDecodedAsReconstructed) {
    for (const int quantiser : {1, 2, 4, 12, 31})
        for (const Effort effort : {Effort::fast, Effort::quality}) {
            SCOPED_TRACE(quantiser);
            Settings s = perceptual(144, 96, quantiser, 5, 2);
            s.effort = effort;
            const glm::vec2 step{2.5f, -1.0f};
            expect_decoders_agree(encode(
                                      s, 7, [&](std::int64_t n) { return textured(s, n, glm::dvec2(step)); },
                                      [&](const PicturePlan& plan) { return steady_motion(s, plan, step); }),
                                  0.15);
            expect_decoders_agree(
                encode(s, 4, [&](std::int64_t n) { return noise(144, 96, n, static_cast<std::uint64_t>(n)); }), 0.15);
        }
}

/// Energies of a film's errors of low and of other frequencies.
struct Bands {
    double low = 0, high = 0;
};
Bands error_bands(const Film& film, const Paint& source) {
    Bands bands;
    for (const CodedPicture& coded : film.coded) {
        const core::Picture picture = source(coded.plan.number);
        const auto& a = picture.y;
        const auto& b = coded.reconstruction.y;
        for (int row = 0; row + 8 <= a.height(); row += 8)
            for (int column = 0; column + 8 <= a.width(); column += 8) {
                float c[64];
                mpeg2::kernels().forward_dct_of_difference(c, a.row(row) + column, a.width(), b.row(row) + column,
                                                           b.width());
                for (int i = 1; i < 64; ++i)
                    (i / 8 + i % 8 < 5 ? bands.low : bands.high) += static_cast<double>(c[i]) * c[i];
            }
    }
    return bands;
}

TEST(WeightingMatrices, ErrorsMoveToFrequenciesThatTheEyeSeesLessOf) {
    const Settings plain = settings(96, 96, 4, 4, 3, 0), tuned = perceptual(96, 96, 4, 4, 0);
    const Paint grain = [](std::int64_t n) {
        core::Picture p = noise(96, 96, n, static_cast<std::uint64_t>(n));
        for (std::uint8_t& v : p.y.values()) v = static_cast<std::uint8_t>(64 + v / 2);
        return p;
    };
    const Bands before = error_bands(encode(plain, 4, grain), grain),
                after = error_bands(encode(tuned, 4, grain), grain);
    EXPECT_GT(after.high / after.low, 1.2 * before.high / before.low);
    EXPECT_LT(after.high / after.low, 4.0 * before.high / before.low);
}

TEST(WeightingMatrices, MatricesAndWeightsFallTogether) {
    const mpeg2::Matrices matrices = mpeg2::matrices_for(Tune::perceptual);
    const float* weights = mpeg2::weights_for(Tune::perceptual, PictureType::intra)->of;
    EXPECT_EQ(matrices.intra[0], 8);
    EXPECT_GT(matrices.intra[63], 5 * matrices.intra[1]);
    EXPECT_GT(matrices.non_intra[63], 1.5 * matrices.non_intra[1]);
    EXPECT_LT(weights[63], 0.15f * weights[1]);
    EXPECT_TRUE(mpeg2::matrices_for(Tune::psnr) == mpeg2::Matrices{});
    EXPECT_EQ(mpeg2::weights_for(Tune::psnr, PictureType::intra), nullptr);
    for (const PictureType type : {PictureType::predicted, PictureType::bidirectional}) {
        EXPECT_EQ(mpeg2::weights_for(Tune::psnr, type)->of[0], mpeg2::mean_weight);
        EXPECT_EQ(mpeg2::weights_for(Tune::psnr, type)->of[1], 1);
        EXPECT_EQ(mpeg2::weights_for(Tune::perceptual, type)->of[0], mpeg2::mean_weight * weights[0]);
        EXPECT_EQ(mpeg2::weights_for(Tune::perceptual, type)->of[63], weights[63]);
    }
}

TEST(Precision, SmoothShadesKeepTheirMeansAtTheFinestQuantisers) {
    // With 8 bits of intra DC a block's mean is off by up to half a code value.
    double worst = 0, sum = 0;
    for (const int quantiser : {1, 2}) {
        const Settings s = settings(128, 64, quantiser, 1);
        const Paint slope = [&](std::int64_t n) {
            return paint(s.width, s.height, n, [](int, double x, double y) { return 60 + 0.137 * x + 0.061 * y; });
        };
        const Film film = encode(s, 1, slope);
        expect_decoders_agree(film, 0.15);
        const core::Picture source = slope(0);
        for (int row = 0; row < s.height; row += 8)
            for (int column = 0; column < s.width; column += 8) {
                double mean = 0;
                for (int y = row; y < row + 8; ++y)
                    for (int x = column; x < column + 8; ++x)
                        mean += (film.coded[0].reconstruction.y.at(x, y) - source.y.at(x, y)) / 64.0;
                worst = std::max(worst, std::abs(mean));
                sum += std::abs(mean) / (2 * 128);
            }
    }
    EXPECT_LT(sum, 0.15);
    EXPECT_LT(worst, 0.5);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
