#include "perceptual/display.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/sampling.h"

namespace render2mpeg::perceptual {
namespace {

/// A scene's worth of luminances, spread evenly over four stops around `middle`.
std::vector<float> scene(float middle, std::size_t count = 10000) {
    std::vector<float> samples;
    for (std::size_t i = 0; i < count; ++i) samples.push_back(middle * std::exp2(4.0f * core::uniform(7, i) - 2.0f));
    return samples;
}

TEST(AutoExposure, BringsTheMiddleToMidGrey) {
    for (const float middle : {1e-6f, 0.003f, 0.18f, 1.0f, 700.0f, 1e9f}) {
        const float ev = auto_exposure(scene(middle));
        EXPECT_NEAR(std::log2(middle) + ev, std::log2(0.18f), 0.05f) << middle;
    }
}

TEST(AutoExposure, IsOneStopLessForTwiceTheLight) {
    std::vector<float> samples = scene(0.4f);
    const float once = auto_exposure(samples);
    for (float& s : samples) s *= 2;
    EXPECT_NEAR(auto_exposure(samples), once - 1.0f, 1e-5f);
}

TEST(AutoExposure, IsZeroWithoutLight) {
    EXPECT_EQ(auto_exposure({}), 0.0f);
    const std::vector<float> black(100, 0.0f);
    EXPECT_EQ(auto_exposure(black), 0.0f);
    const std::vector<float> broken{std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                                    -1.0f};
    EXPECT_EQ(auto_exposure(broken), 0.0f);
}

TEST(AutoExposure, DoesNotSeeBlackPixels) {
    std::vector<float> samples = scene(0.4f);
    const float alone = auto_exposure(samples);
    samples.insert(samples.end(), 20000, 0.0f);
    EXPECT_EQ(auto_exposure(samples), alone);
    samples.insert(samples.end(), 20000, 1e-7f);
    EXPECT_NEAR(auto_exposure(samples), alone, 1e-6f);
}

TEST(AutoExposure, IsNotLedAstrayByLampsAndWindows) {
    std::vector<float> samples = scene(0.4f);
    const float alone = auto_exposure(samples);
    samples.insert(samples.end(), 500, 4000.0f);
    EXPECT_NEAR(auto_exposure(samples), alone, 0.25f);
    samples.insert(samples.end(), 1500, 12.0f);
    EXPECT_NEAR(auto_exposure(samples), alone, 0.75f);
    EXPECT_LT(auto_exposure(samples), alone);
}

TEST(AutoExposure, TakesTheSkyOnlyWhereThereIsLittleElse) {
    const std::vector<float> ground = scene(0.1f, 2000), sky = scene(20.0f, 30000);
    EXPECT_EQ(auto_exposure(ground, sky), auto_exposure(ground));
    const std::vector<float> bird = scene(0.1f, 500);
    EXPECT_NEAR(auto_exposure(bird, sky), auto_exposure(sky), 0.1f);
    EXPECT_EQ(auto_exposure({}, sky), auto_exposure(sky));
    const std::vector<float> night(30000, 0.0f);
    EXPECT_EQ(auto_exposure(bird, night), auto_exposure(bird));
}

TEST(AutoExposure, DoesNotDependOnTheOrder) {
    std::vector<float> samples = scene(3.0f);
    const float forward = auto_exposure(samples);
    std::reverse(samples.begin(), samples.end());
    EXPECT_EQ(auto_exposure(samples), forward);
    std::rotate(samples.begin(), samples.begin() + 3333, samples.end());
    EXPECT_EQ(auto_exposure(samples), forward);
}

TEST(AutoExposure, IsAlwaysOneThatADisplayTakes) {
    for (const float light : {1e-44f, 1e-38f, 1e-20f, 1e20f, 3e38f}) {
        const float ev = auto_exposure(std::vector<float>{light});
        EXPECT_NO_THROW(Display(ev, ColorMatrix::bt709)) << light;
    }
}

}  // namespace
}  // namespace render2mpeg::perceptual
