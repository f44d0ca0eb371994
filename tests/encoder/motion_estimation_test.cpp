#include "encoder/mpeg2/motion/motion_estimation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "film.h"

/// Vectors of a row are chosen together.
namespace render2mpeg::encoder::mpeg2 {
namespace {

using encoder::testing::noise;

struct Way {
    Vector vector;
    float bits;
};

/// The least cost of columns from `column` on, by trying all ways through them.
float least_of_all(const std::vector<std::vector<Way>>& ways, std::size_t column, Vector prediction,
                   const VectorBits& bits) {
    if (column == ways.size()) return 0;
    float least = std::numeric_limits<float>::max();
    for (const Way& way : ways[column])
        least = std::min(least, way.bits + static_cast<float>(bits(way.vector, prediction)) +
                                    least_of_all(ways, column + 1, way.vector, bits));
    return least;
}

TEST(CostToGo, IsThatOfTheBestOfAllWays) {
    std::mt19937 random(7);
    const auto component = [&] { return static_cast<std::int16_t>(static_cast<int>(random() % 33) - 16); };
    for (const bool zero_is_implicit : {false, true}) {
        const VectorBits bits(2, 2, zero_is_implicit);
        std::vector<std::vector<Way>> ways(6, std::vector<Way>(CostToGo::most));
        for (auto& column : ways)
            for (Way& way : column) way = {{component(), component()}, static_cast<float>(random() % 20)};
        CostToGo behind;
        for (std::size_t column = ways.size(); column-- > 0;) {
            CostToGo here;
            for (const Way& way : ways[column]) here.add(way.vector, way.bits + behind(way.vector, bits));
            behind = here;
        }
        for (int i = 0; i < 50; ++i) {
            const Vector a{component(), component()}, b{component(), component()};
            EXPECT_FLOAT_EQ(behind(a, bits) - behind(b, bits),
                            least_of_all(ways, 0, a, bits) - least_of_all(ways, 0, b, bits));
        }
    }
}

TEST(CostToGo, IsNothingAtTheRowsEnd) {
    EXPECT_EQ(CostToGo()({5, -3}, VectorBits(1, 1, false)), 0);
}

/// A row of noise that moved by `v`, but for one flat macroblock, which any vector predicts.
TEST(MotionEstimation, AMacroblockThatFitsAllVectorsHandsThoseOfItsNeighboursOn) {
    const Vector v{6, 4};
    Frame reference(6, 4), source(6, 4);
    pad(noise(96, 64, 0, 3), reference);
    constexpr int flat = 3;
    for (int row = 0; row < 4; ++row)
        for (int y = std::max(0, 16 * row - 8); y < std::min(64, 16 * row + 24); ++y)
            for (int x = 16 * flat - 8; x < 16 * flat + 24; ++x) reference.y.at(x, y) = 128;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 96; ++x)
            source.y.at(x, y) = reference.y.at(std::min(95, x + v.x / 2), std::min(63, y + v.y / 2));
    core::Plane<Candidates> exact(6, 4);
    // Vectors that are told lie within the picture.
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 5; ++column) exact.at(column, row).add(v);
    const MotionEstimate estimate = estimate_motion({source, reference, &exact, nullptr, 4, 14.0f, true});
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 5; ++column) {
            const BestVectors& best = estimate.vectors.at(column, row);
            EXPECT_EQ(best.vector[0], v) << column << ", " << row;
            EXPECT_EQ(best.difference[0], 0u);
        }
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
