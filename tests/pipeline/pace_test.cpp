#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "app/system/progress.h"

/// The time to go, held against records of films.
namespace render2mpeg {
namespace {

using app::Pace;

/// CPU seconds of the frames of films of 96x54 to 192x108 pixels, at default settings, and where light begins anew.
struct Record {
    const char* film;
    std::vector<std::int64_t> firsts;
    std::vector<double> seconds;
};
/// The rule was fitted on these, with others.
const std::vector<Record> fitted{
    {"character", {0}, {1.52, 0.83, 0.8,  0.74, 1.28, 0.62, 0.59, 0.6,  1.37, 0.57, 0.54, 0.58,
                        1.49, 0.52, 0.53, 0.51, 1.21, 0.53, 0.55, 0.47, 1.25, 0.52, 0.59, 0.55,
                        1.33, 0.6,  0.58, 0.64, 1.48, 0.68, 0.65, 0.66, 1.19, 0.74, 0.76, 1.22}},
    {"colonnade", {0}, {5.96, 0.95, 0.85, 3.14, 0.53, 0.59, 2.54, 0.42, 0.5,  2.41, 0.41, 0.4,
                        2.24, 0.39, 0.38, 2.03, 0.36, 0.44, 1.99, 0.37, 0.4,  0.41, 2.07, 0.34,
                        0.41, 0.38, 1.89, 0.41, 0.45, 2.06, 0.51, 0.57, 1.46, 0.65, 0.6,  1.39}},
    {"flash_cut",
     {0, 36, 60},
     {2.91, 1.93, 2.74, 1.79, 2.52, 1.81, 2.44, 1.61, 2.37, 1.74, 2.68, 1.71, 2.67, 0.79, 2.06, 1.36, 2.29, 1.35,
      2.24, 1.45, 2.14, 2.88, 3.41, 1.29, 2.46, 1.92, 1.97, 2.02, 2.6,  1.89, 2.76, 0.54, 0.57, 0.32, 0.43, 0.66,
      3.12, 2.05, 3.5,  1.86, 1.87, 1.76, 2.98, 1.7,  2.89, 1.71, 3.01, 1.71, 2.97, 1.76, 3.07, 1.74, 2.95, 1.92,
      3.53, 1.33, 2.02, 1.56, 2.11, 2,    1.88, 0.99, 1.45, 0.33, 0.61, 0.46, 0.9,  0.61, 0.93, 0.77, 1.03, 1.19}},
    {"many_lamps", {0}, {11.97, 6.91, 12.8,  6.15, 13.22, 5.68, 12.86, 5.52, 11.6,  5.52, 13.13, 5.49,
                         12.93, 5.9,  12.96, 5.42, 12.47, 5.91, 12.84, 6.36, 10.14, 5.81, 8.95,  8.58}},
    {"mirror_and_glass", {0}, {5.25, 4.25, 4.02, 4.08, 5.49, 3.32, 3.42, 3.51, 5.08, 3.07, 2.98, 3.03,
                               5.06, 3.07, 2.93, 2.84, 4.76, 2.83, 2.69, 2.55, 4.18, 2.66, 2.6,  2.64,
                               4.48, 3.17, 3.13, 3.09, 4.9,  3.11, 3.15, 3.06, 4.41, 3.37, 3.23, 4.18}},
    {"still_room", {0}, {12.4, 2.95, 0.22, 0.22, 7.2,  1.33, 0.22, 0.22, 5.32, 0.99, 0.23, 0.22,
                         4.54, 0.94, 0.23, 0.22, 4.14, 0.93, 0.22, 0.22, 3.9,  1.01, 0.22, 0.22,
                         3.75, 0.99, 0.22, 0.22, 3.62, 0.98, 0.22, 0.22, 2.8,  0.88, 0.22, 2.14}},
};
/// These judge it: films of Blender, of which nothing was known.
const std::vector<Record> judged{
    {"corridor", {0}, {3.18, 2.42, 2.55, 2.73, 3.74, 2.24, 2.18, 2.3,  3.48, 1.91, 1.85, 1.9,  3.2,  1.76, 1.76, 1.82,
                       3.06, 1.7,  1.68, 1.71, 3.14, 1.66, 1.68, 1.68, 3.32, 1.64, 1.64, 1.61, 3.05, 1.6,  1.59, 1.52,
                       2.71, 1.51, 1.58, 1.51, 2.85, 1.65, 1.72, 1.61, 2.85, 1.7,  1.66, 1.76, 2.51, 1.66, 1.67, 2.22}},
    {"crane", {0}, {0.31, 0.2,  0.19, 0.22, 0.36, 0.17, 0.18, 0.16, 0.39, 0.21, 0.21, 0.27,
                    0.52, 0.23, 0.26, 0.28, 0.53, 0.23, 0.23, 0.19, 0.41, 0.25, 0.24, 0.2,
                    0.41, 0.18, 0.22, 0.21, 0.46, 0.23, 0.26, 0.26, 0.4,  0.31, 0.28, 0.38}},
    {"dusk", {0}, {4.32, 0.42, 0.35, 0.31, 1.84, 0.23, 0.28, 0.27, 1.66, 0.28, 0.27, 0.28,
                   1.77, 0.27, 0.3,  0.3,  1.56, 0.21, 0.25, 0.24, 1.56, 0.26, 0.28, 0.26,
                   1.58, 0.26, 0.35, 0.34, 1.84, 0.33, 0.41, 0.44, 1.3,  0.35, 0.4,  0.87}},
    {"hail", {0}, {1.9,  1.31, 2.02, 0.82, 1.86, 0.82, 2.59, 0.8,  2.29, 1.09, 2.49, 1.08,
                   1.66, 0.87, 2.04, 0.76, 1.34, 0.76, 1.48, 0.63, 1.63, 0.75, 0.7,  1.87,
                   0.91, 2.23, 1.08, 2.18, 0.82, 1.65, 0.96, 1.32, 0.69, 1.53, 0.61, 0.33}},
    {"walker", {0}, {0.22, 0.06, 0.14, 0.14, 0.17, 0.11, 0.1,  0.1,  0.17, 0.12, 0.1,  0.1,  0.17, 0.1,
                     0.11, 0.12, 0.16, 0.1,  0.1,  0.1,  0.14, 0.09, 0.09, 0.1,  0.16, 0.09, 0.11, 0.11,
                     0.14, 0.09, 0.09, 0.1,  0.13, 0.09, 0.09, 0.1,  0.14, 0.1,  0.11, 0.13}},
};

/// Share of a film's frames, from the second on and but for the last two, after which the time to go is off by more
/// than a quarter.
double share_off(const Record& film) {
    Pace pace(film.firsts);
    int off = 0, all = 0;
    for (std::size_t k = 0; k + 3 < film.seconds.size(); ++k) {
        pace.add(film.seconds[k]);
        if (k == 0) continue;
        const double right =
            std::accumulate(film.seconds.begin() + static_cast<std::ptrdiff_t>(k) + 1, film.seconds.end(), 0.0);
        const double told = pace.left(static_cast<std::int64_t>(film.seconds.size())).value_or(0);
        off += std::abs(told - right) > 0.25 * right ? 1 : 0;
        ++all;
    }
    return static_cast<double>(off) / all;
}

TEST(Pace, TellsTheTimeToGoFromTheSecondFrameOn) {
    double sum = 0;
    for (const Record& film : fitted) {
        EXPECT_LT(share_off(film), 0.55) << film.film;
        sum += share_off(film) / static_cast<double>(fitted.size());
    }
    EXPECT_LT(sum, 0.22);
    sum = 0;
    for (const Record& film : judged) sum += share_off(film) / static_cast<double>(judged.size());
    EXPECT_LT(sum, 0.18);
}

TEST(Pace, CountsTheFirstFramesOfChunksApart) {
    Pace pace({0, 10, 20});
    EXPECT_FALSE(pace.left(30).has_value());
    EXPECT_NEAR(*pace.left(30, 3), 3 + 2 * 6 + 27 * 0.6 * 6, 1e-9) << "half of the first frame, as likely as not";
    pace.add(8);
    EXPECT_NEAR(*pace.left(30), 2 * 8 + 27 * 0.6 * 8, 1e-9) << "others take less than the first";
    for (int i = 0; i < 4; ++i) pace.add(1);
    EXPECT_DOUBLE_EQ(*pace.left(30), 2 * 8 + 23 * 1);
    EXPECT_DOUBLE_EQ(*pace.left(5), 0);
    Pace even;
    even.add(2);
    even.add(2);
    EXPECT_DOUBLE_EQ(*even.left(4), 4);
    // A run that goes on after an earlier one.
    Pace resumed({0, 10, 20});
    resumed.skip(20);
    resumed.add(5);
    resumed.add(1);
    resumed.add(1);
    EXPECT_DOUBLE_EQ(*resumed.left(30), 7);
}

TEST(Pace, KnowsWhatShotsCostBesideEachOther) {
    // Ten frames of a cheap shot, ten of one that takes three times as long.
    std::vector<double> prices(10, 0.1);
    prices.resize(20, 0.3);
    Pace pace({0, 10}, prices);
    pace.add(2);
    EXPECT_NEAR(*pace.left(20), 9 * 0.6 * 2 + 6 + 9 * 0.6 * 6, 1e-9);
    pace.add(1);
    EXPECT_NEAR(*pace.left(20), 8 + 6 + 9 * 3, 1e-9) << "early in the cheap shot, the dear one is known";
    EXPECT_NEAR(pace.per_second(), 1, 1e-9);
    for (int k = 2; k < 10; ++k) pace.add(1);
    pace.add(6);
    EXPECT_NEAR(*pace.left(20), 9 * 3, 1e-9);
    EXPECT_NEAR(pace.per_second(), 1.0 / 3, 1e-9);
    EXPECT_NEAR(*pace.left(22), 9 * 3 + 2 * 2, 1e-9) << "frames that nobody expected are like the mean";
}

TEST(Pace, NeverSaysThatNothingIsLeftWhileAFrameIs) {
    Pace pace({0});
    pace.add(8);
    for (int i = 0; i < 8; ++i) pace.add(1);
    for (const double spent : {0.0, 0.5, 1.0, 3.0, 60.0}) EXPECT_GE(*pace.left(10, spent), 0.2) << spent;
    EXPECT_GE(*pace.left(10, 60), 10) << "one that takes long is not done at once";
    EXPECT_DOUBLE_EQ(*pace.left(9, 5), 0);
}

TEST(Pace, IsThatOfTheLastFewFrames) {
    Pace pace({0});
    pace.add(3);
    for (int i = 0; i < 8; ++i) pace.add(9);
    for (int i = 0; i < 8; ++i) pace.add(i % 4 == 3 ? 2 : 1);
    EXPECT_NEAR(*pace.left(57), 40 * 1.25, 1e-9);
    EXPECT_NEAR(pace.per_second(), 1 / 1.25, 1e-9);
}

}  // namespace
}  // namespace render2mpeg
