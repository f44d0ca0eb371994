#include "app/report/curve_plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

/// Curves of reports.
namespace render2mpeg::app {
namespace {

std::size_t times_in(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + word.size())) ++found;
    return found;
}

CurvePlot plot_of(std::vector<CurvePoint> points, bool logarithmic) {
    return {"A & B", {"x", logarithmic}, {"y", logarithmic}, {{"one", "one", std::move(points)}}};
}

TEST(RoundValues, AreRoundAscendingWithinTheAxisAndNeitherFewNorMany) {
    for (const bool logarithmic : {false, true})
        for (const double low : {1e-7, 0.013, 0.7, 1.0, 40.96, 9.7e5})
            for (const double extent : {1.02, 1.3, 3.0, 70.0, 1e4, 1e15}) {
                const std::vector<double> values = round_values(low, low * extent, logarithmic, 6);
                ASSERT_GE(values.size(), 2u) << low << " " << extent << " " << logarithmic;
                EXPECT_LE(values.size(), 14u) << low << " " << extent << " " << logarithmic;
                for (std::size_t i = 0; i < values.size(); ++i) {
                    EXPECT_GE(values[i], low * (1 - 1e-9));
                    EXPECT_LE(values[i], low * extent * (1 + 1e-9));
                    if (i > 0) {
                        EXPECT_GT(values[i], values[i - 1]);
                    }
                }
            }
    EXPECT_EQ(round_values(0.9, 110, true, 6), (std::vector<double>{1, 3, 10, 30, 100}));
    EXPECT_EQ(round_values(-1.5, 1.5, false, 5), (std::vector<double>{-1.5, -1, -0.5, 0, 0.5, 1, 1.5}));
}

TEST(Curves, ShowEveryPointThatTheAxesHaveOnWideAndNarrowPaper) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    std::vector<CurvePoint> points{
        {1, 2, "a<b", true}, {10, none, "lost", false}, {0, 5, "zero", false}, {100, 3, "", false}};
    const std::string figure = figure_of(plot_of(points, true));
    EXPECT_EQ(times_in(figure, "<svg "), 2u);
    EXPECT_EQ(times_in(figure, "<title>one"), 2u * 2u);
    EXPECT_EQ(times_in(figure, "class=\"ring\""), 2u);
    EXPECT_EQ(times_in(figure, ">a&lt;b<"), 2u);
    EXPECT_EQ(times_in(figure, "lost") + times_in(figure, "zero"), 0u);
    EXPECT_EQ(times_in(figure, "nan") + times_in(figure, "inf"), 0u);
    EXPECT_NE(figure.find("A &amp; B"), std::string::npos);

    // Even axes have 0.
    EXPECT_EQ(times_in(figure_of(plot_of(points, false)), "<title>one"), 2u * 3u);
}

TEST(Curves, OfNothingAndOfOnePointAreDrawnToo) {
    EXPECT_EQ(figure_of(plot_of({}, false)), "");
    EXPECT_EQ(figure_of(plot_of({{0, 0, "", false}}, true)), "");
    for (const bool logarithmic : {false, true}) {
        const std::string figure = figure_of(plot_of({{3, 40, "p", false}, {3, 40, "q", false}}, logarithmic));
        EXPECT_EQ(times_in(figure, "<title>one"), 4u);
        EXPECT_EQ(times_in(figure, "nan") + times_in(figure, "inf"), 0u);
    }
}

}  // namespace
}  // namespace render2mpeg::app
