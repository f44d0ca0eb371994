#include "perceptual/display.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/error.h"
#include "core/sampling.h"
#include "perceptual/signal_curve.h"

namespace render2mpeg::perceptual {
namespace {

core::Radiance frame(int width, int height, glm::vec3 fill = glm::vec3(0)) {
    core::Radiance radiance;
    radiance.frame = 41;
    radiance.combined = core::Plane<glm::vec3>(width, height, fill);
    return radiance;
}

/// Colours of all kinds: dark and bright by 16 stops each way, pale and pure.
glm::vec3 any_color(std::uint64_t i) {
    glm::vec3 c{core::uniform(1, i), core::uniform(2, i), core::uniform(3, i)};
    if (core::uniform(4, i) < 0.2f) c *= c * c * c;
    return c * std::exp2(32.0f * core::uniform(5, i) - 16.0f);
}

struct Codes {
    double y, cb, cr;
};

/// Straight from the recommendations, in double precision. [BT709, 3], [BT601, 2.5], [sRGB, 5.2]
Codes reference(glm::vec3 c, double exposure, ColorMatrix matrix) {
    const bool hd = matrix == ColorMatrix::bt709;
    const double kr = hd ? 0.2126 : 0.299, kb = hd ? 0.0722 : 0.114, kg = 1 - kr - kb;
    const auto signal = [&](double x) { return core::linear_to_srgb(tone_curve(x * std::exp2(exposure))); };
    const double r = signal(c.x), g = signal(c.y), b = signal(c.z), y = kr * r + kg * g + kb * b;
    return {219 * y + 16, 224 * (b - y) / (2 * (1 - kb)) + 128, 224 * (r - y) / (2 * (1 - kr)) + 128};
}

TEST(Display, DevelopsBlackAndWhiteToTheEndsOfTheRange) {
    for (const ColorMatrix matrix : {ColorMatrix::bt601, ColorMatrix::bt709}) {
        const Display display(0, matrix);
        const core::Picture black = display.develop(frame(4, 4));
        const core::Picture white = display.develop(frame(4, 4, glm::vec3(1e30f)));
        EXPECT_EQ(black.y.at(1, 1), 16);
        EXPECT_EQ(black.luma.at(1, 1), 16.0f);
        EXPECT_EQ(white.y.at(1, 1), 235);
        EXPECT_NEAR(white.luma.at(1, 1), 235.0f, 2e-4f);
        for (const core::Picture* p : {&black, &white}) {
            EXPECT_EQ(p->cb.at(0, 0), 128);
            EXPECT_EQ(p->cr.at(0, 0), 128);
        }
    }
}

TEST(Display, ShowsNoLightWhereAlphaIsZero) {
    core::Mattes mattes{3, 1, {0, 1, 2, 3}, {}};
    for (const float open : {1.0f, 0.5f, 0.0f}) mattes.parts.push_back({core::no_id, core::no_id, open});
    const core::Radiance whole = unmultiplied(frame(3, 1, glm::vec3(0.25f)), mattes);
    EXPECT_EQ(whole.combined.at(0, 0), glm::vec3(0)) << "glare, say";
    EXPECT_EQ(whole.combined.at(1, 0), glm::vec3(0.5f));
    EXPECT_EQ(whole.combined.at(2, 0), glm::vec3(0.25f));
}

TEST(Display, AgreesWithTheRecommendationsForEveryColour) {
    for (const ColorMatrix matrix : {ColorMatrix::bt601, ColorMatrix::bt709}) {
        for (const float exposure : {-3.0f, 0.0f, 2.5f}) {
            const Display display(exposure, matrix);
            for (std::uint64_t i = 0; i < 5000; ++i) {
                const glm::vec3 c = any_color(i);
                const core::Picture picture = display.develop(frame(2, 2, c));
                const Codes codes = reference(c, static_cast<double>(exposure), matrix);
                ASSERT_NEAR(picture.luma.at(0, 0), codes.y, 1e-4);
                ASSERT_EQ(picture.luma.at(0, 0), luma_of(display, c));
                ASSERT_NEAR(picture.y.at(1, 0), codes.y, 0.5001);
                ASSERT_NEAR(picture.cb.at(0, 0), codes.cb, 0.5002);
                ASSERT_NEAR(picture.cr.at(0, 0), codes.cr, 0.5002);
            }
        }
    }
}

TEST(Display, PrimariesUseTheWholeRangeOfChromaAndNoMore) {
    const glm::vec3 primaries[] = {{1e9f, 0, 0}, {0, 1e9f, 0}, {0, 0, 1e9f}, {1e9f, 1e9f, 0}, {0, 1e9f, 1e9f}};
    int lowest = 255, highest = 0;
    for (const ColorMatrix matrix : {ColorMatrix::bt601, ColorMatrix::bt709})
        for (const glm::vec3 c : primaries) {
            const core::Picture p = Display(0, matrix).develop(frame(2, 2, c));
            for (const int code : {p.cb.at(0, 0), p.cr.at(0, 0)}) {
                lowest = std::min(lowest, code);
                highest = std::max(highest, code);
            }
        }
    EXPECT_EQ(lowest, 16);
    EXPECT_EQ(highest, 240);
}

TEST(Display, AStopOfExposureIsTwiceTheLight) {
    for (std::uint64_t i = 0; i < 100; ++i)
        EXPECT_EQ(luma_of(Display(1, ColorMatrix::bt709), any_color(i)),
                  luma_of(Display(0, ColorMatrix::bt709), 2.0f * any_color(i)));
}

TEST(Display, CarriesTheFramesNumber) {
    EXPECT_EQ(Display(0, ColorMatrix::bt601).develop(frame(3, 3)).number, 41);
}

/// Where MPEG-2 has its chroma samples: on the even columns, between two rows. A column of colour at x must weigh 1/2
/// in its own sample if x is even and 1/4 in both neighbours if it is odd; every row weighs 1/2 in one sample.
TEST(Display, SitesChromaAsMpeg2Does) {
    const Display display(0, ColorMatrix::bt709);
    const glm::vec3 blue{0, 0, 0.5f};
    const double full = reference(blue, 0, ColorMatrix::bt709).cb - 128;
    for (int column = 2; column <= 3; ++column) {
        core::Radiance radiance = frame(8, 4);
        for (int y = 0; y < 4; ++y) radiance.combined.at(column, y) = blue;
        const core::Picture p = display.develop(radiance);
        for (int y = 0; y < 2; ++y) {
            EXPECT_NEAR(p.cb.at(0, y) - 128, 0, 0);
            EXPECT_NEAR(p.cb.at(1, y) - 128, full * (column == 2 ? 0.5 : 0.25), 0.51);
            EXPECT_NEAR(p.cb.at(2, y) - 128, full * (column == 2 ? 0.0 : 0.25), 0.51);
            EXPECT_NEAR(p.cb.at(3, y) - 128, 0, 0);
        }
    }
    for (int row = 0; row < 4; ++row) {
        core::Radiance radiance = frame(4, 4);
        for (int x = 0; x < 4; ++x) radiance.combined.at(x, row) = blue;
        const core::Picture p = display.develop(radiance);
        EXPECT_NEAR(p.cb.at(0, row / 2) - 128, full * 0.5, 0.51);
        EXPECT_EQ(p.cb.at(0, 1 - row / 2), 128);
    }
}

TEST(Display, RepeatsTheEdgesOfOddSizes) {
    const Display display(0, ColorMatrix::bt601);
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 6}, {7, 1}, {5, 3}, {17, 9}}) {
        // Of one colour, every sample is that colour: no edge may mix in anything else.
        const glm::vec3 c{0.5f, 0.1f, 0.02f};
        const core::Picture p = display.develop(frame(width, height, c));
        const Codes codes = reference(c, 0, ColorMatrix::bt601);
        ASSERT_EQ(p.cb.width(), (width + 1) / 2);
        ASSERT_EQ(p.cr.height(), (height + 1) / 2);
        for (const auto v : p.y.values()) EXPECT_EQ(v, std::lround(codes.y));
        for (const auto v : p.cb.values()) EXPECT_EQ(v, std::lround(codes.cb));
        for (const auto v : p.cr.values()) EXPECT_EQ(v, std::lround(codes.cr));
    }
    EXPECT_TRUE(display.develop(frame(0, 0)).y.empty());
}

TEST(Display, RefusesWhatIsNotFinite) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        core::Radiance radiance = frame(5, 5, glm::vec3(0.2f));
        radiance.combined.at(4, 4).y = bad;
        EXPECT_THROW(Display(0, ColorMatrix::bt709).develop(radiance), core::ContractViolation);
        EXPECT_THROW(Display(0, ColorMatrix::bt709).develop_srgb(radiance), core::ContractViolation);
        EXPECT_THROW(Display(bad, ColorMatrix::bt709), core::ContractViolation);
    }
    // Large is not infinite, not even after the exposure.
    EXPECT_EQ(Display(60, ColorMatrix::bt709).develop(frame(2, 2, glm::vec3(3e38f))).y.at(0, 0), 235);
    EXPECT_EQ(Display(0, ColorMatrix::bt709).develop(frame(2, 2, glm::vec3(-1))).y.at(0, 0), 16);
}

TEST(Display, StillImagesHaveTheCurveThatViewersExpect) {
    const auto rgb = Display(0, ColorMatrix::bt709).develop_srgb(frame(2, 1, {0.02f, 0.18f, 0.002f}));
    EXPECT_EQ(rgb, (std::vector<std::uint8_t>{39, 118, 7, 39, 118, 7})) << "sRGB of 0.02, 0.18 and 0.002";
    const glm::vec3 c{0.03f, 0.4f, 5.0f};
    const auto exposed = Display(0.5f, ColorMatrix::bt709).develop_srgb(frame(1, 1, c));
    for (int i = 0; i < 3; ++i) {
        const double light = tone_curve(static_cast<double>(c[i]) * std::exp2(0.5));
        EXPECT_NEAR(exposed[static_cast<std::size_t>(i)], 255 * (1.055 * std::pow(light, 1 / 2.4) - 0.055), 0.501);
    }
}

TEST(Display, StillBecomesThePictureThatTheLightBehindItBecame) {
    core::Radiance radiance = frame(37, 21);
    for (std::size_t i = 0; i < radiance.combined.size(); ++i) radiance.combined.values()[i] = any_color(i);
    for (const ColorMatrix matrix : {ColorMatrix::bt601, ColorMatrix::bt709}) {
        const Display display(0.5f, matrix);
        const core::Picture developed = display.develop(radiance);
        const std::vector<std::uint8_t> codes = display.develop_srgb(radiance);
        core::Plane<glm::vec3> signals(37, 21);
        for (std::size_t i = 0; i < signals.size(); ++i)
            for (int c = 0; c < 3; ++c)
                signals.values()[i][c] = static_cast<float>(codes[3 * i + static_cast<std::size_t>(c)]) / 255.0f;
        const core::Picture back = picture_of_signals(signals, matrix);
        // Half a step of 255 is 0.43 of 219.
        for (std::size_t i = 0; i < signals.size(); ++i) {
            EXPECT_NEAR(back.luma.values()[i], developed.luma.values()[i], 0.4305f);
            EXPECT_NEAR(back.y.values()[i], developed.y.values()[i], 1);
        }
        for (std::size_t i = 0; i < back.cb.size(); ++i) {
            EXPECT_NEAR(back.cb.values()[i], developed.cb.values()[i], 1);
            EXPECT_NEAR(back.cr.values()[i], developed.cr.values()[i], 1);
        }
    }
}

TEST(Display, SignalsBeyondTheRangeAreItsEnds) {
    const core::Picture low = picture_of_signals(core::Plane<glm::vec3>(2, 2, glm::vec3(-1)), ColorMatrix::bt709);
    const core::Picture high = picture_of_signals(core::Plane<glm::vec3>(2, 2, glm::vec3(9)), ColorMatrix::bt709);
    EXPECT_EQ(low.y.at(0, 0), 16);
    EXPECT_EQ(high.y.at(1, 1), 235);
    EXPECT_EQ(high.cb.at(0, 0), 128);
    core::Plane<glm::vec3> none(2, 2);
    none.at(1, 0).y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(picture_of_signals(none, ColorMatrix::bt709), core::ContractViolation);
}

TEST(WithLuma, GivesBackTheColourItStartedFrom) {
    for (const ColorMatrix matrix : {ColorMatrix::bt601, ColorMatrix::bt709}) {
        const Display display(-1.5f, matrix);
        for (std::uint64_t i = 0; i < 20000; ++i) {
            const glm::vec3 c = any_color(i);
            const float luma = luma_of(display, c);
            if (luma > 234.0f || luma < 16.001f) continue;
            const glm::vec3 back = display.with_luma(c, luma);
            // Luma is right to 1e-4 code values, which is little light where luma rises with it, and more where it
            // hardly does.
            const float rise = (luma_of(display, 1.01f * c) - luma) / 0.01f;
            if (rise <= 0.0f) continue;  // luma tells nothing of light here
            ASSERT_NEAR(core::luminance(back) / core::luminance(c), 1.0f, 1e-5f + 1e-4f / rise) << luma;
        }
    }
}

TEST(WithLuma, HitsEveryLumaThatTheColourCanReach) {
    const Display display(0.7f, ColorMatrix::bt709);
    for (std::uint64_t i = 0; i < 200000; ++i) {
        const glm::vec3 c = any_color(i);
        const float size = std::max({c.x, c.y, c.z});
        const float most = luma_of(display, c * (SignalCurve::brightest / size / std::exp2(0.7f)));
        const float wanted = 16.0f + 219.0f * core::uniform(9, i);
        // Half of them start from a radiance that is far from the answer.
        const float start = i % 2 == 0 ? 1.0f : std::exp2(60.0f * core::uniform(10, i) - 30.0f);
        const glm::vec3 scaled = display.with_luma(c * start, wanted);
        ASSERT_NEAR(luma_of(display, scaled), std::min(wanted, most), 1e-4f);
        ASSERT_LE(luma_of(display, scaled), wanted + 1e-4f);
        // The chromaticity stays.
        const float share = core::luminance(scaled) / core::luminance(c);
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(scaled[k], c[k] * share, 1e-5f * share * size);
    }
}

TEST(WithLuma, RisesWithLuma) {
    const Display display(0, ColorMatrix::bt601);
    for (const glm::vec3 c :
         {glm::vec3(1), glm::vec3(0, 0, 1), glm::vec3(1, 1e-6f, 0), glm::vec3(3e-9f, 1e-9f, 2e-9f)}) {
        float before = -1;
        for (float luma = 16; luma <= 235; luma += 0.25f) {
            const float light = core::luminance(display.with_luma(c, luma));
            ASSERT_GE(light, before);
            before = light;
        }
    }
}

TEST(WithLuma, AnswersTheEnds) {
    const Display display(2, ColorMatrix::bt709);
    EXPECT_EQ(display.with_luma(glm::vec3(1, 2, 3), 16.0f), glm::vec3(0));
    EXPECT_EQ(display.with_luma(glm::vec3(1, 2, 3), -100.0f), glm::vec3(0));
    for (const float luma : {235.0f, 300.0f, std::numeric_limits<float>::infinity()}) {
        const glm::vec3 white = display.with_luma(glm::vec3(1), luma);
        EXPECT_TRUE(std::isfinite(white.x));
        EXPECT_NEAR(luma_of(display, white), 235.0f, 1e-3f);
    }
    // Black is taken as grey; so is what has no finite colour.
    for (const glm::vec3 none : {glm::vec3(0), glm::vec3(std::numeric_limits<float>::infinity()), glm::vec3(-1)}) {
        const glm::vec3 grey = display.with_luma(none, 100.0f);
        EXPECT_EQ(grey.x, grey.y);
        EXPECT_EQ(grey.y, grey.z);
        EXPECT_NEAR(luma_of(display, grey), 100.0f, 1e-4f);
    }
    EXPECT_NEAR(luma_of(display, display.with_luma(glm::vec3(1e-38f, 0, 2e-38f), 40.0f)), 40.0f, 1e-4f);
    EXPECT_NEAR(luma_of(display, display.with_luma(glm::vec3(1e38f, 0, 2e38f), 40.0f)), 40.0f, 1e-4f);
}

/// For grey the inverse is in closed form.
TEST(WithLuma, IsTheAnalyticInverseForGrey) {
    const Display display(-2, ColorMatrix::bt709);
    for (float luma = 16.5f; luma < 234.0f; luma += 0.5f) {
        const double signal = (static_cast<double>(luma) - 16) / 219;
        const double light = inverse_tone_curve(core::srgb_to_linear(signal)) * 4;
        EXPECT_NEAR(display.with_luma(glm::vec3(7), luma).x / light, 1.0, 2e-5 + 4e-6 * light) << luma;
    }
}

TEST(Display, HasAToneCurveInFloat) {
    for (float x = 1e-6f; x < 8; x *= 1.01f)
        EXPECT_NEAR(inverse_tone_curve(Display::tone_curve(x)) / x, 1.0, 1e-6 + 1e-6 * x * x) << x;
    EXPECT_EQ(Display::tone_curve(std::numeric_limits<float>::infinity()), 1.0f);
}

TEST(Display, TakesTheMatrixFromTheNumberOfLines) {
    EXPECT_EQ(matrix_for(576), ColorMatrix::bt601);
    EXPECT_EQ(matrix_for(719), ColorMatrix::bt601);
    EXPECT_EQ(matrix_for(720), ColorMatrix::bt709);
}

}  // namespace
}  // namespace render2mpeg::perceptual
