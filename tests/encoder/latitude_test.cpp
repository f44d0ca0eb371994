#include "encoder/latitude.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

/// Quantisers of panoramas by latitude.
namespace render2mpeg::test {
namespace {

encoder::Settings all_around(int width, int height, encoder::Codec codec = encoder::Codec::h264) {
    encoder::Settings settings;
    settings.codec = codec;
    settings.width = width;
    settings.height = height;
    settings.sphere = encoder::SphereBounds();
    return settings;
}

TEST(Latitude, WeightsOfRowsAreTheirShareOfTheSphere) {
    const std::vector<float> rows = encoder::weights_of_rows(all_around(360, 180));
    ASSERT_EQ(rows.size(), 180u);
    EXPECT_NEAR(rows[89], 1, 1e-4);
    EXPECT_NEAR(rows[29], std::cos(60.5 * 3.14159265 / 180), 1e-5);
    EXPECT_EQ(rows[0], rows[179]);
    // A row's height times its weight, over all rows, is the sphere's height.
    EXPECT_NEAR(std::accumulate(rows.begin(), rows.end(), 0.0) * 3.14159265 / 180, 2, 1e-4);
    encoder::Settings part = all_around(360, 90);
    part.sphere->bottom = 0.5;
    const std::vector<float> upper = encoder::weights_of_rows(part);
    for (std::size_t y = 0; y < upper.size(); ++y) EXPECT_NEAR(upper[y], rows[y], 1e-5);
    EXPECT_TRUE(encoder::weights_of_rows({}).empty()) << "flat pictures";
}

TEST(Latitude, OfTwoEyesIsEachOnesOwn) {
    const std::vector<float> one = encoder::weights_of_rows(all_around(128, 64));
    encoder::Settings both = all_around(128, 128);
    both.packing = core::FramePacking::top_bottom;
    const std::vector<float> rows = encoder::weights_of_rows(both);
    ASSERT_EQ(rows.size(), 128u);
    for (std::size_t y = 0; y < rows.size(); ++y) EXPECT_EQ(rows[y], one[y % 64]);
}

TEST(Latitude, QuantisersGrowWithTheRootOfWhatRowsWeighLessUpToFourTimes) {
    const core::Plane<float> factors = encoder::latitude_factors(all_around(6400, 3200));
    ASSERT_EQ(factors.height(), 200);
    EXPECT_EQ(factors.at(0, 0), 4);
    EXPECT_NEAR(factors.at(7, 99), 1, 1e-3);
    EXPECT_NEAR(factors.at(0, 33), std::sqrt(2.0), 0.02) << "60 degrees";
    for (const encoder::Codec codec : {encoder::Codec::av1, encoder::Codec::prores, encoder::Codec::ffv1})
        EXPECT_TRUE(encoder::latitude_factors(all_around(64, 32, codec)).empty()) << "they take one quantiser";
    for (const encoder::Codec codec : {encoder::Codec::mpeg2, encoder::Codec::hevc})
        EXPECT_FALSE(encoder::latitude_factors(all_around(64, 32, codec)).empty());
    encoder::Settings flat = all_around(64, 32);
    flat.sphere.reset();
    EXPECT_TRUE(encoder::latitude_factors(flat).empty());
}

}  // namespace
}  // namespace render2mpeg::test
