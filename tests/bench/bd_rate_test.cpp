#include "bd_rate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render2mpeg::bench {
namespace {

const std::vector<RatePoint> curve = {{1e6, 44.1}, {5.2e5, 40.3}, {2.4e5, 36.0}, {1.1e5, 32.2}};

std::vector<RatePoint> changed(double rate_factor, double shift) {
    std::vector<RatePoint> points = curve;
    for (RatePoint& p : points) {
        p.bits *= rate_factor;
        p.psnr += shift;
    }
    return points;
}

TEST(BdRate, IsNothingBetweenEqualCurves) {
    EXPECT_NEAR(bd_rate(curve, curve), 0, 1e-9);
}

TEST(BdRate, IsTheFactorWhereAllRatesDifferByOne) {
    EXPECT_NEAR(bd_rate(curve, changed(0.8, 0)), -20, 1e-6);
    EXPECT_NEAR(bd_rate(curve, changed(1.25, 0)), 25, 1e-6);
}

TEST(BdRate, TurnsIntoItsInverseWithTheRolesExchanged) {
    const std::vector<RatePoint> other = {{9.1e5, 44.0}, {5.0e5, 40.9}, {2.5e5, 36.9}, {1.0e5, 32.1}};
    EXPECT_NEAR((1 + bd_rate(curve, other) / 100) * (1 + bd_rate(other, curve) / 100), 1, 1e-9);
}

TEST(BdRate, SeesBetterQualityAsFewerBits) {
    EXPECT_LT(bd_rate(curve, changed(1, 0.5)), -5);
    EXPECT_GT(bd_rate(curve, changed(1, -0.5)), 5);
}

TEST(BdRate, OfPublishedCurvesIsWhatOthersFind) {
    // Curves that are handed round as examples. The values are of an evaluation apart from this one: slopes in Fritsch
    // and Butland's form, integrals by Simpson's rule, which is exact for cubics. With one cubic through all four
    // points, as [Bjontegaard2001] had it, they are -4.4205 and 31.3974.
    const std::vector<RatePoint> fine = {{9487.76, 40.037}, {4593.60, 38.615}, {2486.44, 36.845}, {1358.24, 34.851}},
                                 fine_test = {{9787.80, 40.121},
                                              {4469.00, 38.651},
                                              {2451.52, 36.970},
                                              {1356.24, 34.987}},
                                 coarse = {{686.76, 40.28}, {309.58, 37.18}, {157.11, 34.24}, {85.95, 31.42}},
                                 coarse_test = {{893.34, 40.39}, {407.8, 37.21}, {204.93, 34.17}, {112.75, 31.24}};
    EXPECT_NEAR(bd_rate(fine, fine_test), -4.4174854, 1e-4);
    EXPECT_NEAR(bd_rate(coarse, coarse_test), 31.3798782, 1e-4);
}

TEST(BdRate, OfPointsOfOneQualityTheCheapestCounts) {
    std::vector<RatePoint> twice = curve;
    twice.push_back({curve[1].bits * 2, curve[1].psnr});
    EXPECT_NEAR(bd_rate(curve, twice), 0, 1e-9);
    EXPECT_NEAR(bd_rate(twice, changed(0.8, 0)), -20, 1e-6);
    EXPECT_TRUE(std::isnan(bd_rate(curve, {{1e5, 38}, {2e5, 38}})));
}

TEST(BdRate, IsNoNumberWhereNoQualityIsReachedByBoth) {
    EXPECT_TRUE(std::isnan(bd_rate(curve, changed(1, 20))));
}

TEST(Pchip, GoesThroughItsPointsAndNeverBeyondNeighbours) {
    const std::vector<double> x = {0, 1, 2.5, 3, 7}, y = {0, 0.1, 4, 4, 9};
    const Pchip p(x, y);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(p.at(x[i]), y[i], 1e-12);
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
        for (int k = 1; k < 20; ++k) {
            const double v = p.at(x[i] + (x[i + 1] - x[i]) * k / 20);
            EXPECT_GE(v, y[i] - 1e-12);
            EXPECT_LE(v, y[i + 1] + 1e-12);
        }
}

}  // namespace
}  // namespace render2mpeg::bench
