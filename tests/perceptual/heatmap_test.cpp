#include "perceptual/heatmap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace render2mpeg::perceptual {
namespace {

HeatScale percent() {
    return {"TOLERANCE", 0.01f, 1.0f, true, {{0.01f, "1%"}, {0.1f, "10%"}, {1.0f, "100%"}}};
}

float luma(glm::vec3 signal) {
    return glm::dot(luma_weights(ColorMatrix::bt709), signal);
}

TEST(HeatColor, GrowsBrighterAllTheWay) {
    const HeatScale scale = percent();
    float before = -1;
    for (int i = 0; i <= 200; ++i) {
        const float now = luma(heat_color(0.01f * std::pow(100.0f, static_cast<float>(i) / 200.0f), scale));
        EXPECT_GT(now, before) << i;
        before = now;
    }
    EXPECT_FLOAT_EQ(luma(heat_color(0.01f, scale)), 0.0f);
    EXPECT_FLOAT_EQ(luma(heat_color(1.0f, scale)), 1.0f);
}

TEST(HeatColor, EndsAtItsEnds) {
    const HeatScale scale = percent();
    EXPECT_EQ(heat_color(0.0f, scale), heat_color(0.01f, scale));
    EXPECT_EQ(heat_color(-5.0f, scale), heat_color(0.01f, scale));
    EXPECT_EQ(heat_color(1e30f, scale), heat_color(1.0f, scale));
    EXPECT_EQ(heat_color(std::numeric_limits<float>::quiet_NaN(), scale), glm::vec3(0.5f));
    EXPECT_EQ(heat_color(std::numeric_limits<float>::infinity(), scale), glm::vec3(0.5f));
}

TEST(Heatmap, ShowsItsValuesAboveItsLegend) {
    core::Plane<float> values(96, 40, 0.01f);
    values.at(50, 20) = 1.0f;
    const core::Picture picture = heatmap(values, percent(), ColorMatrix::bt601);
    ASSERT_EQ(picture.width(), 96);
    ASSERT_EQ(picture.height(), 40 + legend_height);
    EXPECT_EQ(picture.y.at(50, 20), 235);
    EXPECT_EQ(picture.y.at(10, 10), 16);
    // The bar rises from left to right.
    for (int x = 12; x + 8 < 92; x += 8) EXPECT_LT(picture.y.at(x, 40 + 14), picture.y.at(x + 8, 40 + 14)) << x;
}

TEST(Heatmap, WritesTheWordsOfItsTitleThatFit) {
    const auto shown = [](int width, const char* title) {
        HeatScale scale = percent();
        scale.title = title;
        const core::Picture picture = heatmap(core::Plane<float>(width, 8, 0.5f), scale, ColorMatrix::bt709);
        return std::string(picture.y.values().begin(), picture.y.values().end());
    };
    const char* title = "TOLERANCE / LUMINANCE";
    EXPECT_EQ(shown(96, title), shown(96, "TOLERANCE"));
    EXPECT_NE(shown(160, title), shown(160, "TOLERANCE"));
    EXPECT_EQ(shown(128, title), shown(128, "TOLERANCE"));  // one letter less than it takes
    EXPECT_EQ(shown(96, "CUT: CLUSTERS PER PIXEL"), shown(96, "CUT: CLUSTERS"));
    EXPECT_EQ(shown(30, "CUT: CLUSTERS PER PIXEL"), shown(30, "CUT"));
    EXPECT_EQ(shown(16, title), shown(16, "TOL")) << "the first word is cut";
}

TEST(Heatmap, WritesWhatItsTitleSays) {
    const core::Plane<float> values(96, 8, 0.5f);
    HeatScale t = percent(), l = percent();
    t.title = "T";
    l.title = "L";
    const auto rows = [&](const HeatScale& scale) {
        const core::Picture picture = heatmap(values, scale, ColorMatrix::bt709);
        std::string text;
        for (int y = 0; y < 7; ++y, text += '\n')
            for (int x = 0; x < 5; ++x) text += picture.y.at(4 + x, 8 + 2 + y) > 128 ? '#' : '.';
        return text;
    };
    EXPECT_EQ(rows(t), "#####\n..#..\n..#..\n..#..\n..#..\n..#..\n..#..\n");
    EXPECT_EQ(rows(l), "#....\n#....\n#....\n#....\n#....\n#....\n#####\n");
}

TEST(Heatmap, FitsPicturesOfAnySize) {
    for (const int width : {1, 3, 9, 40, 200})
        for (const int height : {1, 7, 50})
            EXPECT_EQ(heatmap(core::Plane<float>(width, height, 0.5f), percent(), ColorMatrix::bt709).width(), width);
}

TEST(Heatmap, MarksNeverCoverOneAnother) {
    HeatScale crowded = percent();
    crowded.marks.clear();
    for (int i = 0; i < 100; ++i) crowded.marks.push_back({0.01f + 0.01f * static_cast<float>(i), "88"});
    const core::Picture picture = heatmap(core::Plane<float>(120, 8, 0.5f), crowded, ColorMatrix::bt709);
    // Between two numbers of two digits there is at least one column without ink.
    int longest = 0, run = 0;
    for (int x = 0; x < 120; ++x) {
        bool ink = false;
        for (int y = 0; y < 7; ++y) ink = ink || picture.y.at(x, 8 + 22 + y) > 128;
        run = ink ? run + 1 : 0;
        longest = std::max(longest, run);
    }
    EXPECT_LE(longest, 5);
    EXPECT_GT(longest, 0);
}

}  // namespace
}  // namespace render2mpeg::perceptual
