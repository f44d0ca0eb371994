#include "perceptual/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>
#include <string>

#include "core/sampling.h"
#include "encoder/av/y4m.h"
#include "support/program.h"

namespace render2mpeg::perceptual {
namespace {

using Samples = core::Plane<std::uint8_t>;

/// A soft pattern with noise of `strength` code values.
Samples noisy_samples(int width, int height, std::uint64_t seed, float strength) {
    Samples p(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto index = static_cast<std::uint64_t>(y * width + x);
            const float pattern =
                120 + 60 * std::sin(0.11f * static_cast<float>(x)) + 40 * std::cos(0.07f * static_cast<float>(y));
            p.at(x, y) = static_cast<std::uint8_t>(
                std::clamp(pattern + strength * (core::uniform(seed, index) - 0.5f), 0.0f, 255.0f));
        }
    return p;
}

core::Picture picture(int width, int height, std::uint64_t seed, float strength) {
    core::Picture p;
    p.y = noisy_samples(width, height, seed, strength);
    p.cb = noisy_samples((width + 1) / 2, (height + 1) / 2, seed + 1000, strength / 2);
    p.cr = noisy_samples((width + 1) / 2, (height + 1) / 2, seed + 2000, strength / 3);
    return p;
}

TEST(MeanSquaredError, IsTheSquareOfAConstantDifference) {
    EXPECT_EQ(mean_squared_error(Samples(7, 5, 10), Samples(7, 5, 13)), 9.0);
    EXPECT_EQ(mean_squared_error(Samples(7, 5, 255), Samples(7, 5, 0)), 65025.0);
    EXPECT_EQ(mean_squared_error(Samples(), Samples()), 0.0);
    EXPECT_THROW(mean_squared_error(Samples(7, 5), Samples(5, 7)), core::ContractViolation);
    // Rows by weight.
    Samples lower(4, 2, 10);
    lower.at(0, 1) = 14;
    const float rows[] = {3, 1};
    EXPECT_EQ(mean_squared_error(Samples(4, 2, 10), lower, rows), 1.0);
    EXPECT_EQ(mean_squared_error(Samples(4, 2, 10), lower), 2.0);
}

TEST(Psnr, FallsByTenDecibelsForTenTimesTheError) {
    EXPECT_NEAR(psnr(65025.0), 0.0, 1e-12);
    EXPECT_NEAR(psnr(1.0), 48.1308, 1e-4);
    EXPECT_NEAR(psnr(3.0) - psnr(30.0), 10.0, 1e-12);
    EXPECT_EQ(psnr(0.0), std::numeric_limits<double>::infinity());
}

TEST(Ssim, IsOneForEqualPlanesOnly) {
    const Samples a = noisy_samples(64, 48, 1, 20), b = noisy_samples(64, 48, 2, 20);
    EXPECT_NEAR(ssim(a, a), 1.0, 1e-12);
    EXPECT_LT(ssim(a, b), 0.99);
    EXPECT_GT(ssim(a, b), 0.2);
    EXPECT_EQ(ssim(a, b), ssim(b, a));
}

TEST(Ssim, IsNegativeForAnInvertedPattern) {
    Samples a(16, 16), b(16, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            a.at(x, y) = (x + y) % 2 ? 200 : 56;
            b.at(x, y) = (x + y) % 2 ? 56 : 200;
        }
    EXPECT_LT(ssim(a, b), -0.9);
}

TEST(Ssim, OfOneFlatWindowIsTheLuminanceTerm) {
    // Variances are 0, so that only means and the first constant count [Wang2004, eq. 6]: 416 / 64^2 in ffmpeg, where
    // the paper has 0.01^2 255^2 = 6.5.
    const double c1 = 416.0 / 4096, a = 100, b = 120;
    EXPECT_NEAR(ssim(Samples(8, 8, 100), Samples(8, 8, 120)), (2 * a * b + c1) / (a * a + b * b + c1), 1e-12);
}

TEST(Ssim, TakesPlanesTooSmallForAWindowWhole) {
    EXPECT_EQ(ssim(Samples(1, 1, 9), Samples(1, 1, 9)), 1.0);
    EXPECT_LT(ssim(Samples(1, 1, 9), Samples(1, 1, 200)), 0.5);
    EXPECT_NEAR(ssim(noisy_samples(7, 3, 1, 20), noisy_samples(7, 3, 1, 20)), 1.0, 1e-12);
    EXPECT_LT(ssim(noisy_samples(7, 3, 1, 90), noisy_samples(7, 3, 2, 90)), 1.0);
    EXPECT_EQ(ssim(Samples(), Samples()), 1.0);
}

/// The number that follows `label` in ffmpeg's report.
double reported(const std::string& text, const std::string& label) {
    std::smatch match;
    if (!std::regex_search(text, match, std::regex(label + ":([0-9.]+|inf)"))) return std::nan("");
    return match[1] == "inf" ? std::numeric_limits<double>::infinity() : std::stod(match[1]);
}

class AgainstFfmpeg : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(AgainstFfmpeg, FilmQualityAgreesToFourDigits) {
    const auto [width, height] = GetParam();
    const support::Folder folder;
    FilmQuality quality;
    av::Y4mWriter first(folder / "a.y4m", width, height, core::frame_rate_from("25"));
    av::Y4mWriter second(folder / "b.y4m", width, height, core::frame_rate_from("25"));
    for (std::uint64_t n = 0; n < 5; ++n) {
        const core::Picture a = picture(width, height, 10 * n, 4),
                            b = picture(width, height, 10 * n + 5, 10 + 20.0f * static_cast<float>(n));
        first.write(a);
        second.write(b);
        quality.add(a, b);
    }
    first.finish();
    second.finish();

    // ffmpeg's own x86 code for ssim is wrong for planes whose number of 4x4 columns is no multiple of 4: take the
    // plain one.
    const std::string inputs =
        "ffmpeg -cpuflags 0 -hide_banner -i " + (folder / "a.y4m").string() + " -i " + (folder / "b.y4m").string();
    const support::Outcome p = support::run(inputs + " -lavfi psnr -f null -");
    const support::Outcome s = support::run(inputs + " -lavfi ssim -f null -");
    ASSERT_EQ(p.status, 0) << p.output;
    EXPECT_NEAR(quality.psnr_y(), reported(p.output, "PSNR y"), 2e-6 * 30 + 5e-5);
    EXPECT_NEAR(quality.ssim_y(), reported(s.output, "SSIM Y"), 2e-6);
    EXPECT_EQ(quality.pictures(), 5);
}

INSTANTIATE_TEST_SUITE_P(Sizes, AgainstFfmpeg, ::testing::Values(std::pair{64, 48}, std::pair{83, 61}));
INSTANTIATE_TEST_SUITE_P(SizesSlow, AgainstFfmpeg, ::testing::Values(std::pair{352, 288}, std::pair{130, 34}));

TEST(FilmQuality, OfNothingAndOfEqualPicturesIsPerfect) {
    FilmQuality quality;
    EXPECT_EQ(quality.psnr_y(), std::numeric_limits<double>::infinity());
    EXPECT_EQ(quality.ssim_y(), 1.0);
    quality.add(picture(33, 17, 1, 9), picture(33, 17, 1, 9));
    EXPECT_EQ(quality.psnr_y(), std::numeric_limits<double>::infinity());
    EXPECT_NEAR(quality.ssim_y(), 1.0, 1e-12);
}

TEST(FilmQuality, AveragesErrorsNotDecibels) {
    core::Picture grey, off;
    for (core::Picture* p : {&grey, &off}) p->y = p->cb = p->cr = Samples(8, 8, p == &grey ? 100 : 104);
    FilmQuality quality;
    quality.add(grey, grey);
    quality.add(grey, off);
    EXPECT_NEAR(quality.psnr_y(), psnr(8.0), 1e-12);
}

}  // namespace
}  // namespace render2mpeg::perceptual
