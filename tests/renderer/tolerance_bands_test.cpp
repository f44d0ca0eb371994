#include "renderer/base/tolerance_bands.h"

#include <gtest/gtest.h>

#include <limits>

namespace render2mpeg::renderer {
namespace {

TEST(ToleranceBands, HaveEveryToleranceInOneOfThem) {
    EXPECT_EQ(ToleranceBands::band_of(0.0f), 0u);
    EXPECT_EQ(ToleranceBands::band_of(0.0099f), 0u);
    for (std::size_t i = 0; i < ToleranceBands::ends.size(); ++i)
        EXPECT_EQ(ToleranceBands::band_of(ToleranceBands::ends[i]), i + 1) << "an end belongs to the band above";
    EXPECT_EQ(ToleranceBands::band_of(0.0199f), 1u);
    EXPECT_EQ(ToleranceBands::band_of(std::numeric_limits<float>::infinity()), ToleranceBands::count - 1);
}

TEST(ToleranceBands, AddUp) {
    ToleranceBands a, b;
    a.add(0.03f, 2, 70);
    b.add(0.02f, 1, 30);
    b.add(1.0f, 4, 40);
    a.add(b);
    EXPECT_EQ(a.points, (std::array<std::uint64_t, 6>{0, 0, 3, 0, 0, 4}));
    EXPECT_EQ(a.clusters, (std::array<std::uint64_t, 6>{0, 0, 100, 0, 0, 40}));
}

}  // namespace
}  // namespace render2mpeg::renderer
