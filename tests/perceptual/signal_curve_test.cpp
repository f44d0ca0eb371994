#include "perceptual/signal_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace render2mpeg::perceptual {
namespace {

double exact(double exposed) {
    const double shown = tone_curve(exposed);
    return shown <= 0.0031308 ? 12.92 * shown : 1.055 * std::pow(shown, 1 / 2.4) - 0.055;  // [sRGB, 5.2]
}

/// Calls `check` at `steps` places of [2^from, 2^to], evenly on a logarithmic scale.
template <class Check>
void sweep(double from, double to, int steps, Check check) {
    for (int i = 0; i <= steps; ++i) check(std::exp2(from + (to - from) * i / steps));
}

TEST(ToneCurve, IsTheIdentityBelowItsKnee) {
    for (const double x : {0.0, 1e-30, 0.001, 0.18, 0.5, 0.625}) {
        EXPECT_EQ(tone_curve(x), x);
        EXPECT_EQ(inverse_tone_curve(x), x);
    }
}

TEST(ToneCurve, ReachesOneAtInfinityAndNotBefore) {
    EXPECT_LT(tone_curve(1e6), 1.0);
    EXPECT_GT(tone_curve(1e6), 1.0 - 1e-6);
    EXPECT_EQ(tone_curve(std::numeric_limits<double>::infinity()), 1.0);
}

TEST(ToneCurve, LeavesRoomAboveADiffuseWhite) {
    EXPECT_NEAR(tone_curve(1.0), 0.8125, 1e-12);
    EXPECT_NEAR(tone_curve(8.0), 1.0 - 0.140625 / 7.75, 1e-12);
}

TEST(ToneCurve, RisesWithASlopeThatNeverJumps) {
    double slope_before = 1.0;
    sweep(-6, 6, 20000, [&](double x) {
        const double h = 1e-6 * x;
        const double slope = (tone_curve(x + h) - tone_curve(x - h)) / (2 * h);
        EXPECT_GT(slope, 0.0);
        EXPECT_NEAR(slope, slope_before, 0.003);
        slope_before = slope;
    });
}

TEST(ToneCurve, IsUndoneByItsInverse) {
    sweep(-40, 20, 10000, [](double x) { EXPECT_NEAR(inverse_tone_curve(tone_curve(x)) / x, 1.0, 1e-9); });
    for (int i = 0; i < 10000; ++i) {
        const double y = i / 10000.0;
        EXPECT_NEAR(tone_curve(inverse_tone_curve(y)), y, 1e-15);
    }
}

TEST(ToneCurve, TakesNothingFromNaNAndNegativeLight) {
    EXPECT_EQ(tone_curve(-1.0), 0.0);
    EXPECT_EQ(inverse_tone_curve(-1.0), 0.0);
}

TEST(SignalCurve, IsRightToATenThousandthOfACodeValue) {
    const SignalCurve& curve = SignalCurve::instance();
    double worst = 0;
    sweep(-30, 40, 1000000, [&](double x) {
        const auto light = static_cast<float>(x);
        worst = std::max(worst, std::abs(curve.signal(light) - exact(static_cast<double>(light))) * 219);
    });
    EXPECT_LT(worst, 1e-4);
    EXPECT_GT(worst, 1e-7) << "the table cannot be better than float";
}

TEST(SignalCurve, NeverFalls) {
    const SignalCurve& curve = SignalCurve::instance();
    float before = 0;
    sweep(-8, 19, 300000, [&](double x) {
        const float signal = curve.signal(static_cast<float>(x));
        EXPECT_GE(signal, before - 2e-7f) << x;
        EXPECT_LE(signal, 1.0f);
        before = std::max(before, signal);
    });
}

TEST(SignalCurve, KnowsItsOwnSlope) {
    const SignalCurve& curve = SignalCurve::instance();
    sweep(-12, 17, 3000, [&](double x) {
        const double h = 1e-4 * x;
        const double slope = x * (exact(x + h) - exact(x - h)) / (2 * h);
        const SignalCurve::Point point = curve.point(static_cast<float>(x));
        EXPECT_EQ(point.signal, curve.signal(static_cast<float>(x)));
        EXPECT_NEAR(point.log_slope, slope, 0.01 * slope + 2e-5) << x;
    });
}

TEST(SignalCurve, AnswersTheEndsOfFloat) {
    const SignalCurve& curve = SignalCurve::instance();
    EXPECT_EQ(curve.signal(0.0f), 0.0f);
    EXPECT_EQ(curve.signal(-3.0f), 0.0f);
    EXPECT_EQ(curve.signal(std::numeric_limits<float>::quiet_NaN()), 0.0f);
    EXPECT_GT(curve.signal(std::numeric_limits<float>::min()), 0.0f);
    EXPECT_EQ(curve.signal(std::numeric_limits<float>::infinity()), curve.signal(SignalCurve::brightest));
    EXPECT_NEAR(curve.signal(std::numeric_limits<float>::max()), 1.0f, 1e-6f);
    EXPECT_EQ(curve.point(std::numeric_limits<float>::infinity()).log_slope, 0.0f);
    EXPECT_EQ(curve.point(std::numeric_limits<float>::quiet_NaN()).signal, 0.0f);
}

}  // namespace
}  // namespace render2mpeg::perceptual
