#include "perceptual/view_transform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "core/sampling.h"
#include "perceptual/display.h"
#include "perceptual/inverse_luma.h"

namespace render2mpeg::perceptual {
namespace {

using core::View;
using core::ViewName;

/// All of Blender's views, and some with a gamma.
std::vector<View> blender_views() {
    std::vector<View> views;
    for (std::size_t i = 1; i < core::view_names.size(); ++i)
        if (View{static_cast<ViewName>(i)}.is_blenders()) views.push_back({static_cast<ViewName>(i)});
    for (const ViewName name : {ViewName::standard, ViewName::filmic, ViewName::agx})
        for (const float gamma : {0.7f, 1.4f}) views.push_back({name, gamma});
    return views;
}

/// Colours of every saturation, 7 stops below white to 2 above.
glm::vec3 some_color(std::uint64_t i) {
    return glm::vec3(core::uniform(1, i), core::uniform(2, i), core::uniform(3, i)) *
           std::exp2(9.0f * core::uniform(4, i) - 7.0f);
}

TEST(ViewTransform, StandardIsTheCurveOfSrgbCutOffAtOne) {
    const ViewTransform view({ViewName::standard});
    for (int i = 0; i <= 4000; ++i) {
        const float light = std::exp2(-14.0f + static_cast<float>(i) / 200);
        const float exact = core::linear_to_srgb(std::min(light, 1.0f));
        EXPECT_NEAR(view.signals(glm::vec3(light)).y, exact, 1e-4f / 219) << light;
    }
    EXPECT_EQ(view.signals({2, 0, -1}), glm::vec3(1, 0, 0));
}

/// What Blender 3.4's Filmic shows of grey, 2^-11 to 2^4, for each look: saved as PNG of 16 bits.
constexpr std::array<float, 13> stops{-11, -9, -7, -5, -4, -3, -2, -1, 0, 1, 2, 3, 4};
struct LookOfBlender {
    ViewName name;
    std::array<float, 13> shown;
};
constexpr std::array<LookOfBlender, 7> looks_of_blender{{
    {ViewName::filmic,
     {0.0072f, 0.0297f, 0.0853f, 0.2090f, 0.3076f, 0.4297f, 0.5642f, 0.6950f, 0.8072f, 0.8923f, 0.9494f, 0.9832f,
      0.9997f}},
    {ViewName::filmic_very_high_contrast,
     {0.0006f, 0.0041f, 0.0224f, 0.1086f, 0.2190f, 0.3922f, 0.5981f, 0.7752f, 0.8899f, 0.9512f, 0.9806f, 0.9940f,
      0.9999f}},
    {ViewName::filmic_high_contrast,
     {0.0018f, 0.0098f, 0.0404f, 0.1453f, 0.2546f, 0.4080f, 0.5843f, 0.7450f, 0.8629f, 0.9355f, 0.9745f, 0.9929f,
      0.9999f}},
    {ViewName::filmic_medium_high_contrast,
     {0.0036f, 0.0173f, 0.0595f, 0.1761f, 0.2815f, 0.4194f, 0.5737f, 0.7187f, 0.8339f, 0.9131f, 0.9612f, 0.9875f,
      0.9998f}},
    {ViewName::filmic_medium_low_contrast,
     {0.0113f, 0.0422f, 0.1078f, 0.2343f, 0.3268f, 0.4372f, 0.5568f, 0.6745f, 0.7807f, 0.8675f, 0.9317f, 0.9745f,
      0.9995f}},
    {ViewName::filmic_low_contrast,
     {0.0178f, 0.0596f, 0.1347f, 0.2602f, 0.3453f, 0.4440f, 0.5495f, 0.6547f, 0.7550f, 0.8432f, 0.9143f, 0.9661f,
      0.9994f}},
    {ViewName::filmic_very_low_contrast,
     {0.0262f, 0.0791f, 0.1610f, 0.2822f, 0.3600f, 0.4492f, 0.5427f, 0.6361f, 0.7302f, 0.8193f, 0.8969f, 0.9580f,
      0.9992f}},
}};

TEST(ViewTransform, FilmicShowsGreyAsBlenderDoesToACodeValue) {
    double worst = 0;
    for (const LookOfBlender& look : looks_of_blender) {
        const ViewTransform view({look.name});
        for (std::size_t i = 0; i < stops.size(); ++i) {
            const float shown = view.signals(glm::vec3(std::exp2(stops[i]))).x;
            worst = std::max(worst, static_cast<double>(255 * std::abs(shown - look.shown[i])));
        }
    }
    EXPECT_LT(worst, 1.05);
    EXPECT_GT(worst, 0.05) << "a fit, no copy";
}

TEST(ViewTransform, FilmicFadesLampsToWhiteAsBlenderDoes) {
    struct Lamp {
        glm::vec3 stops, shown;
    };
    constexpr float none = -14;
    const ViewTransform view({ViewName::filmic});
    for (const Lamp& lamp : {Lamp{{3, none, none}, {0.9832f, 0, 0}}, Lamp{{4, 1, -5}, {0.9997f, 0.8925f, 0.2318f}},
                             Lamp{{5, none, none}, {1, 0.3087f, 0.3087f}}, Lamp{{5, 2, none}, {1, 0.9503f, 0.3087f}},
                             Lamp{{6, 4, -2}, {1, 1, 0.7294f}}, Lamp{{7, none, none}, {1, 0.8756f, 0.8756f}},
                             Lamp{{7, 5, 1}, {1, 1, 0.9443f}}, Lamp{{8, none, 3}, {1, 0.9819f, 0.9994f}}}) {
        const glm::vec3 shown = view.signals(glm::exp2(lamp.stops));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], lamp.shown[c], 2.1f / 255) << lamp.stops.x << " " << c;
    }
}

TEST(ViewTransform, AgxIsNearBlenders) {
    // What Blender 4.3 shows: greys and strong colours.
    struct Color {
        glm::vec3 stops, shown;
    };
    const ViewTransform view({ViewName::agx});
    double worst = 0, sum = 0;
    int count = 0;
    for (const Color& color :
         {Color{{-6, -6, -6}, {0.1045f, 0.1045f, 0.1045f}}, Color{{-2.5f, -2.5f, -2.5f}, {0.4574f, 0.4573f, 0.4573f}},
          Color{{1, 1, 1}, {0.8518f, 0.8518f, 0.8518f}}, Color{{0, -3, -5}, {0.835f, 0.4228f, 0.2726f}},
          Color{{-4, -1, -2}, {0.3988f, 0.6604f, 0.535f}}, Color{{-5, -4, 2}, {0.5401f, 0.6384f, 0.9679f}},
          Color{{4, 1, -1}, {1, 0.8723f, 0.8292f}}, Color{{-1, -2, 3}, {0.7418f, 0.7734f, 0.9967f}}}) {
        const glm::vec3 shown = view.signals(glm::exp2(color.stops));
        for (int c = 0; c < 3; ++c, ++count) {
            const double error = 255 * std::abs(static_cast<double>(shown[c] - color.shown[c]));
            worst = std::max(worst, error);
            sum += error;
        }
    }
    EXPECT_LT(worst, 9);
    EXPECT_LT(sum / count, 3);
    EXPECT_GT(worst, 0.5) << "a fit, no copy";
}

TEST(ViewTransform, KeepsGreyGreyAndRisesFromBlackToWhite) {
    for (const View& named : blender_views()) {
        const ViewTransform view(named);
        float before = 0;
        for (float stop = -16; stop < 10; stop += 0.01f) {
            const glm::vec3 shown = view.signals(glm::vec3(std::exp2(stop)));
            EXPECT_NEAR(shown.x, shown.y, 1e-5f) << text_of(named) << " " << stop;
            EXPECT_NEAR(shown.z, shown.y, 1e-5f) << text_of(named) << " " << stop;
            EXPECT_GE(shown.y, before - 2e-6f) << text_of(named) << " " << stop;
            before = shown.y;
        }
        EXPECT_EQ(view.signals(glm::vec3(0)), glm::vec3(0));
        EXPECT_NEAR(before, 1.0f, 1e-6f);
    }
}

TEST(ViewTransform, KnowsItsOwnSlopeAndTheGreyBehindASignal) {
    for (const View& named : blender_views()) {
        const ViewTransform view(named);
        for (int i = 1; i < 1000; ++i) {
            const double signal = i / 1000.0;
            const auto light = static_cast<float>(view.grey_light(signal));
            EXPECT_NEAR(static_cast<double>(view.signals(glm::vec3(light)).y), signal, 1e-5) << text_of(named);
        }
        for (std::uint64_t i = 0; i < 4000; ++i) {
            const glm::vec3 color = some_color(i);
            // Where a channel is cut off the slope is meant to be another.
            const glm::vec3 shown = view.signals(color * 1.01f);
            if (std::max({shown.x, shown.y, shown.z}) >= 1.0f) continue;
            constexpr float step = 2e-3f;
            const ShownLight here = view.show(color);
            for (int c = 0; c < 3; ++c) {
                if (here.signal[c] < 0.01f) continue;
                const float slope =
                    (view.signals(color * std::exp(step))[c] - view.signals(color * std::exp(-step))[c]) / (2 * step);
                EXPECT_NEAR(here.log_slope[c], slope, 0.01f * slope + 2e-4f) << text_of(named) << " " << i << " " << c;
            }
            EXPECT_EQ(here.signal, view.signals(color));
        }
    }
}

TEST(ViewTransform, OfHighDynamicRangeKnowsItsSlopeAndTheLightOfSignals) {
    for (const View& named : {View{ViewName::pq}, View{ViewName::pq, 1, 4000}, View{ViewName::hlg}}) {
        const ViewTransform view(named);
        for (std::uint64_t i = 0; i < 4000; ++i) {
            const glm::vec3 color = some_color(i);
            constexpr float step = 2e-3f;
            const ShownLight here = view.show(color);
            const glm::vec3 back = view.shown_light(here.signal);
            const float most = std::max({color.x, color.y, color.z});
            for (int c = 0; c < 3; ++c) {
                const float slope =
                    (view.signals(color * std::exp(step))[c] - view.signals(color * std::exp(-step))[c]) / (2 * step);
                EXPECT_NEAR(here.log_slope[c], slope, 0.01f * slope + 2e-4f) << text_of(named) << " " << i << " " << c;
            }
            if (most >= 2) continue;  // bent
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(back[c], color[c], 2e-3f * most) << text_of(named) << " " << i;
        }
        EXPECT_EQ(view.signals(glm::vec3(0)), glm::vec3(0));
        EXPECT_TRUE(
            glm::all(glm::lessThanEqual(view.signals(glm::vec3(std::numeric_limits<float>::max())), glm::vec3(1))));
    }
    EXPECT_NEAR(ViewTransform({ViewName::pq}).luminances(glm::vec3(1)).y, 203.0f, 0.1f);
    EXPECT_LT(ViewTransform({ViewName::pq}).luminances(glm::vec3(1e6f)).y, 1000.5f);
}

TEST(ViewTransform, LampsSlopesAreThoseOfTheirFading) {
    // Filmic mixes channels above 12; the channel at white is cut off, the others are not.
    const ViewTransform view({ViewName::filmic});
    for (const glm::vec3 lamp : {glm::vec3(20, 0.1f, 0), glm::vec3(1, 40, 0.3f), glm::vec3(0.5f, 0.01f, 90)})
        for (int c = 0; c < 3; ++c) {
            if (view.signals(lamp * 1.01f)[c] >= 1.0f) continue;
            const float slope = (view.signals(lamp * 1.002f)[c] - view.signals(lamp / 1.002f)[c]) / 0.004f;
            EXPECT_NEAR(view.show(lamp).log_slope[c], slope, 0.01f * slope + 3e-4f) << lamp.x << " " << c;
        }
}

TEST(ViewTransform, ChannelsCutOffAtWhiteNeverFallByMoreThanTheirSlopeSays) {
    const ViewTransform view({ViewName::standard});
    for (float light = 1; light < 3; light *= 1.03f)
        for (float factor = 0.99f; factor > 0.5f; factor *= 0.97f) {
            const float fall = 1 - view.signals(glm::vec3(light * factor)).y;
            EXPECT_LE(fall, -std::log(factor) * 1.005f * view.show(glm::vec3(light)).log_slope.y + 1e-4f)
                << light << " " << factor;
        }
    EXPECT_EQ(view.show(glm::vec3(2.01f)).log_slope.y, 0.0f) << "nothing falls from there by less than half";
}

TEST(ViewTransform, TakesEverythingThatFloatHolds) {
    const float huge = std::numeric_limits<float>::max(), infinite = std::numeric_limits<float>::infinity(),
                nothing = std::numeric_limits<float>::quiet_NaN();
    for (const View& named : blender_views()) {
        const ViewTransform view(named);
        EXPECT_NEAR(view.signals(glm::vec3(huge)).y, 1.0f, 1e-5f);
        EXPECT_NEAR(view.signals(glm::vec3(infinite)).y, 1.0f, 1e-5f);
        EXPECT_EQ(view.signals(glm::vec3(nothing)), glm::vec3(0));
        for (const glm::vec3 light : {glm::vec3(huge, 0, 0), glm::vec3(0, 1e-30f, infinite), glm::vec3(-1, 3, nothing)})
            for (int c = 0; c < 3; ++c) {
                EXPECT_TRUE(std::isfinite(view.show(light).signal[c])) << text_of(named);
                EXPECT_TRUE(std::isfinite(view.show(light).log_slope[c])) << text_of(named);
            }
    }
    EXPECT_THROW(ViewTransform(View{}), core::ContractViolation);
    EXPECT_THROW(ViewTransform({ViewName::agx, 0.01f}), core::ContractViolation);
}

/// What colours send, and how their luma would follow.
PixelLight light_of_colors(const Display& display, int count, core::Radiance& radiance) {
    radiance.combined = core::Plane<glm::vec3>(count, 1);
    for (int i = 0; i < count; ++i) radiance.combined.at(i, 0) = some_color(static_cast<std::uint64_t>(i));
    return InverseLuma(display).light_of(display.develop(radiance), radiance);
}

TEST(Views, LumaIsUndoneForEveryColour) {
    for (const View& named : blender_views()) {
        const Display display(0.5f, ColorMatrix::bt709, named);
        for (std::uint64_t i = 0; i < 300; ++i)
            for (const float luma : {16.5f, 30.0f, 100.0f, 200.0f, 234.0f}) {
                const glm::vec3 color = some_color(i) * (i % 3 == 0 ? 100.0f : 1.0f);
                if (luma_of(display, color * 1e5f) < luma + 0.01f) continue;
                EXPECT_NEAR(luma_of(display, display.with_luma(color, luma)), luma, 3e-4f) << text_of(named);
            }
        EXPECT_NEAR(luma_of(display, display.with_luma(glm::vec3(1), 16.5f)), 16.5f, 3e-4f) << text_of(named);
        EXPECT_EQ(display.with_luma(glm::vec3(1), 16.0f), glm::vec3(0));
        EXPECT_NEAR(luma_of(display, display.with_luma(glm::vec3(0), 16.5f)), 16.5f, 1e-3f) << text_of(named);
    }
}

TEST(Views, TolerancesMoveLumaByNoMoreThanTheirDistance) {
    // Light is wrong by a tolerance that hides a distance; luma is to move by that distance, in either direction.
    for (const View& named : blender_views())
        for (const ColorMatrix matrix : {ColorMatrix::bt601, ColorMatrix::bt709}) {
            const Display display(0, matrix, named);
            const InverseLuma inverse(display);
            core::Radiance radiance;
            const int count = 3000;
            const PixelLight pixels = light_of_colors(display, count, radiance);
            std::vector<float> down, up;
            for (int i = 0; i < count; ++i) {
                const float luma = pixels.luma.at(i, 0), luminance = pixels.luminance.at(i, 0);
                if (luma < 17.0f) continue;
                for (const float distance : {20.0f, 5.0f, 1.0f}) {
                    const float share =
                        inverse.difference(luma, luminance, pixels.exponent.at(i, 0), distance) / luminance;
                    const glm::vec3 color = radiance.combined.at(i, 0);
                    if (share < 1) down.push_back((luma - luma_of(display, color * (1 - share))) / distance);
                    up.push_back((luma_of(display, color * (1 + share)) - luma) / distance);
                }
            }
            std::sort(down.begin(), down.end());
            std::sort(up.begin(), up.end());
            ASSERT_GT(down.size(), 4000u);
            // The median is the distance itself: tolerances have no slack.
            EXPECT_NEAR(down[down.size() / 2], 1.0f, 0.02f) << text_of(named);
            EXPECT_LT(down[down.size() * 99 / 100], 1.3f) << text_of(named);
            EXPECT_LT(up[up.size() * 99 / 100], named.name == ViewName::agx ? 1.25f : 1.15f) << text_of(named);
        }
}

/// The largest response of luma to light of one channel, per luminance, over that to light of the pixel's own colour.
std::vector<float> responses_to_other_colors(const Display& display) {
    std::vector<float> responses;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const glm::vec3 color = some_color(i);
        if (const float luma = luma_of(display, color); luma < 20 || luma > 230) continue;
        const float own =
            (luma_of(display, color * 1.01f) - luma_of(display, color * 0.99f)) / (0.02f * core::luminance(color));
        float largest = 0;
        for (int c = 0; c < 3; ++c) {
            glm::vec3 more = color;
            const float step = 0.01f * std::max(color[c], 0.01f);
            more[c] += step;
            largest = std::max(
                largest, (luma_of(display, more) - luma_of(display, color)) / (step * core::luminance_weights[c]));
        }
        if (own > 0.5f) responses.push_back(largest / own);
    }
    std::sort(responses.begin(), responses.end());
    return responses;
}

TEST(Views, AgxBoundsWhatLightOfAnotherColourDoesToLuma) {
    // g / L of docs/model/display.md: mixing before the logarithm keeps every channel off black.
    const std::vector<float> agx = responses_to_other_colors(Display(0, ColorMatrix::bt709, {ViewName::agx})),
                             neutral = responses_to_other_colors(Display(0, ColorMatrix::bt709));
    EXPECT_NEAR(agx[agx.size() / 2], 1.9f, 0.3f);
    EXPECT_NEAR(agx[agx.size() * 99 / 100], 6.8f, 1.5f);
    EXPECT_GT(neutral[neutral.size() * 99 / 100], 2 * agx[agx.size() * 99 / 100]);
}

}  // namespace
}  // namespace render2mpeg::perceptual
