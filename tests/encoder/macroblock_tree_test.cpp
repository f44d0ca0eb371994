#include "encoder/mpeg2/macroblock/macroblock_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "encoder/innovation.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "film.h"

namespace render2mpeg::encoder::testing {
namespace {

/// The factor of a macroblock whose quality `heirs` pictures inherit, where `followers` depend on its picture.
float factor_of(double followers, double heirs) {
    return static_cast<float>(std::pow(1 + followers, mpeg2::propagation_strength) *
                              std::pow(1 + heirs, -mpeg2::inheritance_strength));
}

/// 1/2 + 1/4 + ...: what is predicted between pixels keeps a half each time.
double halves(int count) {
    return 1 - std::pow(0.5, count);
}

TEST(MacroblockTree, OnlyMacroblocksThatStandStillThroughoutAreFinerThanTheirPicture) {
    core::MotionField onward = uniform_motion(50, 32, 3, {0, 0});
    onward.reference = 10;
    onward.vector.at(22, 4) = {0.2f, 0};             // macroblock (1, 0)
    onward.kind.at(36, 0) = core::PixelClass::none;  // (2, 0)
    onward.vector.at(0, 16) = {0.1f, -0.1f};         // (0, 1): a rounding error's worth
    onward.vector.at(48, 30) = {std::nanf(""), 0};   // (3, 1), which hangs over the side
    const core::Plane<float> factors = mpeg2::quantiser_factors(onward, nullptr, 4, 2, 4);
    const float finer = factor_of(7, 7), moving = factor_of(7, halves(7));
    ASSERT_LT(finer, 0.75f);
    ASSERT_NEAR(moving, 1, 0.05f);
    const float part = factor_of(7, halves(7) * 15 / 16);  // a sixteenth of (2, 0) is not there later
    const float expected[2][4] = {{finer, moving, part, finer}, {finer, finer, finer, moving}};
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 4; ++column)
            EXPECT_NEAR(factors.at(column, row), expected[row][column], 1e-6f) << column << ", " << row;
}

TEST(MacroblockTree, WhatIsShownAnewIsInheritedByNobody) {
    core::MotionField onward = uniform_motion(64, 16, 3, {0, 0});
    onward.reference = 10;
    core::Plane<float> innovation(4, 1, 0.0f);
    innovation.at(1, 0) = 1;
    innovation.at(2, 0) = 16 * static_cast<float>(mpeg2::unseen_innovation);
    innovation.at(3, 0) = 1e6f;
    const core::Plane<float> factors = mpeg2::quantiser_factors(onward, &innovation, 4, 1, 4);
    EXPECT_NEAR(factors.at(0, 0), factor_of(7, 7), 1e-6f);
    EXPECT_NEAR(factors.at(1, 0), factor_of(7, 7), 0.02f);
    EXPECT_NEAR(factors.at(2, 0), factor_of(7, halves(7)), 1e-6f) << "the half of it is quantised away";
    EXPECT_NEAR(factors.at(3, 0), factor_of(7, 0), 1e-4f);
}

TEST(Innovation, IsWhatMotionDoesNotExplain) {
    // A texture slides by 2.5 pixels; in the third macroblock a lamp adds 6, the last one shows what came in.
    const core::Picture before = paint(64, 16, 0, [](int plane, double x, double y) { return texture(plane, x, y); });
    core::Plane<std::uint8_t> now(64, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 64; ++x) {
            const int left = std::min(x + 2, 63), right = std::min(x + 3, 63);
            now.at(x, y) = static_cast<std::uint8_t>((before.y.at(left, y) + before.y.at(right, y) + 1) / 2 +
                                                     (x / 16 == 2 ? 6 : 0));
        }
    core::MotionField motion = uniform_motion(64, 16, 1, {2.5f, 0});
    motion.kind.at(0, 0) = core::PixelClass::none;
    const core::Plane<float> means = innovation(&motion, now, before.y);
    ASSERT_EQ(means.width(), 4);
    EXPECT_NEAR(means.at(0, 0), 400.0f / 64, 0.26f) << "one of 64 samples";
    EXPECT_LT(means.at(1, 0), 0.26f);
    EXPECT_NEAR(means.at(2, 0), 36, 4);
    EXPECT_NEAR(means.at(3, 0), 400.0f / 8, 0.3f) << "a column of eight";
    EXPECT_GT(innovation(nullptr, now, before.y).at(1, 0), 4) << "it has moved";
    motion.vector.at(16, 0) = {std::nanf(""), 0};
    EXPECT_GT(innovation(&motion, now, before.y).at(1, 0), 6);
}

/// Mean luma of each macroblock, code values.
core::Plane<float> macroblock_means(const core::Picture& picture) {
    core::Plane<float> means(picture.width() / 16, picture.height() / 16, 0.0f);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x)
            means.at(x / 16, y / 16) += static_cast<float>(picture.y.at(x, y)) / 256;
    return means;
}

/// How much the mean errors of macroblocks change from picture to picture, root mean square.
double pumping_of(const std::vector<CodedPicture>& coded, const std::vector<core::Picture>& film) {
    std::vector<core::Plane<float>> errors(film.size());
    for (const CodedPicture& c : coded) {
        const auto n = static_cast<std::size_t>(c.plan.number);
        errors[n] = macroblock_means(c.reconstruction);
        const core::Plane<float> means = macroblock_means(film[n]);
        for (std::size_t i = 0; i < means.size(); ++i) errors[n].values()[i] -= means.values()[i];
    }
    double sum = 0, count = 0;
    for (std::size_t n = 1; n < film.size(); ++n)
        for (std::size_t i = 0; i < errors[n].size(); ++i, ++count)
            sum += std::pow(static_cast<double>(errors[n].values()[i] - errors[n - 1].values()[i]), 2);
    return std::sqrt(sum / count);
}

TEST(MacroblockTree, LightThatRisesEvenlyIsNoStair) {
    // Each macroblock rises by its own 0.8 to 1.2 code values per picture.
    const Settings s = settings(64, 64, 4, 15, 3, 3);
    std::vector<core::Picture> film;
    for (int n = 0; n < 15; ++n)
        film.push_back(paint(64, 64, n, [&](int plane, double x, double y) {
            const double light = 0.6 + (0.008 + 0.001 * std::floor(x / 16)) * n;
            return plane == 0 ? 16 + light * (texture(0, x, y) - 16) : 128.0;
        }));
    Encoder encoder(s);
    std::vector<CodedPicture> coded;
    for (int n = 0; n < 15; ++n) {
        const PicturePlan plan = encoder.plan(n, {.frames_left = 14 - n, .light_change = 0.9}, n == 0);
        std::vector<core::MotionField> motion;
        for (const std::int64_t reference : plan.references) {
            motion.push_back(uniform_motion(64, 64, n, {0, 0}));
            motion.back().reference = reference;
        }
        core::MotionField onward = uniform_motion(64, 64, n, {0, 0});
        if (plan.horizon) onward.reference = *plan.horizon;
        for (CodedPicture& c :
             encoder.push(film[static_cast<std::size_t>(n)], plan, motion, {plan.horizon ? &onward : nullptr}))
            coded.push_back(std::move(c));
    }
    for (CodedPicture& c : encoder.flush()) coded.push_back(std::move(c));
    ASSERT_EQ(coded.size(), film.size());
    EXPECT_LT(pumping_of(coded, film), 0.4)
        << "0.9 with three B pictures in a row and errors of means that count as others";
}

TEST(MacroblockTree, WhatLeavesThePictureIsCoarserThanWhatStays) {
    core::MotionField onward = uniform_motion(64, 16, 0, {-24, 0});
    onward.reference = 4;
    const core::Plane<float> factors = mpeg2::quantiser_factors(onward, nullptr, 4, 1, 4);
    const float none = factor_of(4, 0), all = factor_of(4, halves(4));
    EXPECT_NEAR(factors.at(0, 0), none, 1e-6f);
    EXPECT_GT(factors.at(1, 0), all);
    EXPECT_LT(factors.at(1, 0), none);
    EXPECT_NEAR(factors.at(2, 0), all, 1e-6f);
    EXPECT_NEAR(factors.at(3, 0), all, 1e-6f);
}

TEST(MacroblockTree, MacroblocksBeyondThePictureAreWorthNothing) {
    // 40 lines shown as fields are coded as 64: whole macroblocks in each field.
    core::MotionField onward = uniform_motion(16, 40, 0, {0, 0});
    onward.reference = 7;
    const core::Plane<float> factors = mpeg2::quantiser_factors(onward, nullptr, 1, 4, 4);
    EXPECT_LT(factors.at(0, 2), 0.7f) << "half of it is seen";
    EXPECT_GE(factors.at(0, 3), 1.0f);
}

/// A picture whose left half stands still while the right one slides.
core::Picture half_still(const Settings& s, std::int64_t n) {
    return paint(s.width, s.height, n, [&](int plane, double x, double y) {
        return texture(plane, x < s.width / 2 ? x : x - 2.25 * static_cast<double>(n), y);
    });
}
core::MotionField half_still_motion(const Settings& s, std::int64_t n, std::int64_t reference) {
    core::MotionField field = uniform_motion(s.width, s.height, n, {0, 0});
    field.reference = reference;
    for (int y = 0; y < s.height; ++y)
        for (int x = s.width / 2; x < s.width; ++x)
            field.vector.at(x, y) = {2.25f * static_cast<float>(reference - n), 0};
    return field;
}

Film encode_half_still(const Settings& s, int count, bool hinted) {
    Film film{s, {}};
    Encoder encoder(s);
    for (int n = 0; n < count; ++n) {
        const PicturePlan plan = encoder.plan(n, {.frames_left = count - 1 - n}, n == 0);
        std::vector<core::MotionField> motion;
        for (const std::int64_t reference : plan.references) motion.push_back(half_still_motion(s, n, reference));
        core::MotionField onward;
        if (plan.horizon) onward = half_still_motion(s, n, *plan.horizon);
        const Hints hints{hinted && plan.horizon ? &onward : nullptr};
        for (CodedPicture& coded : encoder.push(half_still(s, n), plan, motion, hints))
            film.coded.push_back(std::move(coded));
    }
    return film;
}

double squared_error(const Film& film) {
    double sum = 0;
    for (const CodedPicture& coded : film.coded) {
        const core::Picture source = half_still(film.settings, coded.plan.number);
        for (std::size_t i = 0; i < source.y.size(); ++i) {
            const double d = source.y.values()[i] - coded.reconstruction.y.values()[i];
            sum += d * d;
        }
    }
    return sum;
}

TEST(MacroblockTree, ReferencesAskForMotionToTheEndOfTheirGop) {
    const Settings s = settings(32, 32, 4, 7, 3, 2);
    Encoder encoder(s);
    for (int n = 0; n < 12; ++n) {
        const PicturePlan plan = encoder.plan(n, {.frames_left = 11 - n}, n == 0);
        const int end = n < 7 ? 6 : 11;
        if (plan.type == PictureType::bidirectional || n == end)
            EXPECT_FALSE(plan.horizon) << n;
        else
            EXPECT_EQ(plan.horizon, end) << n;
    }
}

TEST(MacroblockTree, WhatStandsStillIsFinerAndPaysForThat) {
    const Settings s = settings(192, 96, 8, 15, 3, 2);
    const Film plain = encode_half_still(s, 15, false), hinted = encode_half_still(s, 15, true);
    expect_decoders_agree(hinted, 0.25);
    const auto& records = hinted.coded[0].macroblocks;
    for (int row = 0; row < records.height(); ++row) {
        EXPECT_EQ(records.at(2, row).quantiser, 4);  // 8 * 15^-0.26
        EXPECT_EQ(records.at(8, row).quantiser, 6);  // 8 * 15^-0.08
    }
    // A decibel more in the whole film, for bits that would buy a part of it by a finer quantiser throughout.
    const double gain = 10 * std::log10(squared_error(plain) / squared_error(hinted));
    const double bits = static_cast<double>(hinted.bytes().size()) / static_cast<double>(plain.bytes().size());
    EXPECT_GT(gain, 0.6);
    EXPECT_LT(gain, 3.0);
    EXPECT_LT(bits, 1.2);
    EXPECT_GT(bits, 0.9);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
