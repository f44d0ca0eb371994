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

/// CPU seconds of the frames of films of 160 to 192 pixels, at default settings. The rule was chosen by the first
/// three; the fourth judges it.
struct Record {
    const char* film;
    std::vector<double> seconds;
};
const std::vector<Record> records{
    {"character", {2.25, 1.19, 1.27, 1.17, 1.25, 1.15, 1.27, 1.18, 1.29, 1.17, 1.26, 1.14, 1.23, 1.19, 1.25,
                   1.33, 1.23, 1.36, 1.22, 1.39, 1.22, 1.31, 1.19, 1.28, 1.15, 1.13, 1.2,  1.16, 1.25, 1.27}},
    {"flash", {2.91, 1.3,  1.58, 1.3, 1.62, 1.36, 1.64, 1.42, 1.61, 1.37, 1.55, 1.34, 0.96, 0.95, 1.07,
               1.77, 0.92, 1.26, 0.9, 1.18, 1.43, 1.13, 0.87, 1.62, 1.36, 1.53, 1.31, 1.5,  1.31, 1.48}},
    {"still", {8.98, 0.33, 0.59, 0.17, 0.16, 0.16, 0.29, 0.16, 0.16, 0.16, 0.22, 0.16,
               0.16, 0.16, 0.19, 0.21, 0.16, 0.16, 0.16, 0.19, 0.16, 0.16, 0.16, 0.18}},
    {"cornell",
     {2.67, 1.31, 1.53, 1.32, 1.58, 1.27, 1.26, 1.3, 1.57, 1.37, 1.33, 1.44, 1.21, 1.39, 1.44, 1.63, 1.32, 1.58,
      1.28, 1.66, 1.39, 1.58, 1.29, 1.56, 1.31, 1.6, 1.42, 1.51, 1.35, 1.64, 1.64, 1.35, 1.49, 1.34, 1.46, 1.44}},
    {"colonnade", {6.64, 2.16, 2.95, 1.8,  3.06, 1.82, 3.04, 1.79, 2.86, 1.65, 2.57, 1.83,
                   2.69, 1.95, 2.34, 2.99, 2.18, 2.86, 2.02, 2.7,  1.81, 2.43, 1.82, 2.34}},
    {"flash_cut",
     {3.66, 1.63, 2.03, 1.63, 2.23, 1.81, 2.21, 1.69, 2.16, 1.64, 1.97, 1.67, 1.7,  1.28, 1.74, 2.07, 1.2,  1.43,
      1.11, 1.5,  1.79, 1.44, 1.18, 2.16, 1.8,  2.11, 1.77, 1.71, 1.74, 1.92, 2.32, 1.31, 1.41, 1.21, 1.25, 1.31,
      4.84, 2.28, 2.95, 2.18, 2.77, 1.99, 2.75, 2.15, 2.78, 2.25, 2.61, 2.1,  2.41, 2.03, 2.36, 2.87, 2.11, 2.77,
      1.83, 1.95, 2,    1.67, 1.49, 1.67, 4.08, 1.98, 1.43, 1.56, 1.18, 1.18, 1.33, 1.2,  1.26, 1.16, 1.28, 1.24}},
};

double truth(const std::vector<double>& seconds, std::size_t done) {
    return std::accumulate(seconds.begin() + static_cast<std::ptrdiff_t>(done), seconds.end(), 0.0);
}

TEST(Pace, TellsTheTimeToGoAfterATenthOfAFilm) {
    for (const auto& [film, seconds] : records) {
        Pace pace(60);
        // Where light is kept, it is being kept for the first frames: five of them are more than a tenth here.
        const std::size_t known = std::string(film) == "still" ? 5 : std::max<std::size_t>(3, seconds.size() / 10);
        for (std::size_t i = 0; i < known; ++i) pace.add(seconds[i]);
        const auto left = pace.left(static_cast<std::int64_t>(seconds.size()));
        ASSERT_TRUE(left.has_value()) << film;
        const double right = truth(seconds, known);
        EXPECT_NEAR(*left, right, 0.2 * right) << film;
    }
}

TEST(Pace, CountsTheFirstFramesOfChunksApart) {
    Pace pace(10);
    EXPECT_FALSE(pace.left(30).has_value());
    EXPECT_NEAR(*pace.left(30, 3), 3 + 2 * 6 + 27 * 0.6 * 6, 1e-9) << "half of the first frame, as likely as not";
    pace.add(8);
    EXPECT_NEAR(*pace.left(30), 2 * 8 + 27 * 0.6 * 8, 1e-9) << "others take less than the first";
    for (int i = 0; i < 4; ++i) pace.add(1);
    EXPECT_DOUBLE_EQ(*pace.left(30), 2 * 8 + 23 * 1);
    EXPECT_DOUBLE_EQ(*pace.left(5), 0);
    Pace even;
    even.add(2);
    EXPECT_DOUBLE_EQ(*even.left(4), 6);
    // A run that goes on after an earlier one.
    Pace resumed(10);
    resumed.skip(20);
    resumed.add(5);
    resumed.add(1);
    EXPECT_DOUBLE_EQ(*resumed.left(30), 8);
}

TEST(Pace, NeverSaysThatNothingIsLeftWhileAFrameIs) {
    Pace pace(10);
    pace.add(8);
    for (int i = 0; i < 8; ++i) pace.add(1);
    for (const double spent : {0.0, 0.5, 1.0, 3.0, 60.0}) EXPECT_GE(*pace.left(10, spent), 0.2) << spent;
    EXPECT_GE(*pace.left(10, 60), 10) << "one that takes long is not done at once";
    EXPECT_DOUBLE_EQ(*pace.left(9, 5), 0);
}

TEST(Pace, KnowsThatPicturesTakeTurns) {
    Pace one(60, true);
    one.add(3);
    one.add(1);
    EXPECT_DOUBLE_EQ(*one.left(12), 10 * 1.45) << "a B picture is all that is known of others";
    // A P picture takes twice as long as each of its three B pictures.
    Pace pace(60);
    pace.add(3);
    for (int i = 0; i < 8; ++i) pace.add(i % 4 == 0 ? 2 : 1);
    EXPECT_DOUBLE_EQ(*pace.left(49), 40 * 1.25);
}

}  // namespace
}  // namespace render2mpeg
