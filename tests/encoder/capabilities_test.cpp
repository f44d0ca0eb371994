#include "encoder/capabilities.h"

#include <gtest/gtest.h>

#include "film.h"

namespace render2mpeg::encoder::testing {
namespace {

TEST(Capabilities, LevelsAscendAndAreThoseOfTheirSettings) {
    const Capabilities c = capabilities();
    ASSERT_EQ(c.levels.size(), 3u);
    for (std::size_t i = 1; i < c.levels.size(); ++i) {
        EXPECT_GT(c.levels[i].samples, c.levels[i - 1].samples);
        EXPECT_GT(c.levels[i].bit_rate, c.levels[i - 1].bit_rate);
        EXPECT_GT(c.levels[i].buffer_bits, c.levels[i - 1].buffer_bits);
    }
    for (const LevelLimits& level : c.levels) {
        const Settings s = settings(level.width, level.height, 4, 15, 2);
        if (static_cast<std::int64_t>(level.width) * level.height * 24 > level.samples) continue;
        EXPECT_EQ(level_of(s).indication, level.indication) << level.name;
    }
    EXPECT_EQ(std::string(level_of(settings(720, 576)).name), "Main");
    EXPECT_EQ(std::string(level_of(settings(722, 576)).name), "High-1440");
    EXPECT_EQ(std::string(level_of(settings(1920, 1080)).name), "High");
    EXPECT_THROW(level_of(settings(1922, 1080)), core::Error);
    EXPECT_EQ(level_of(settings(720, 576)).vector_x, 1024);
    EXPECT_EQ(level_of(settings(720, 576)).vector_y, 128);
}

TEST(Capabilities, RangesAreWhatCheckAccepts) {
    const Capabilities c = capabilities();
    for (const int quantiser : {c.quantiser_min, c.quantiser_max}) EXPECT_NO_THROW(check(settings(32, 32, quantiser)));
    for (const int quantiser : {c.quantiser_min - 1, c.quantiser_max + 1})
        EXPECT_THROW(check(settings(32, 32, quantiser)), core::Error);
    EXPECT_NO_THROW(check(settings(32, 32, 4, 15, 3, c.most_b_pictures)));
    EXPECT_THROW(check(settings(32, 32, 4, 15, 3, c.most_b_pictures + 1)), core::Error);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
