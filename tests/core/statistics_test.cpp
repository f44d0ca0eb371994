#include "tests/support/statistics.h"

#include <limits>

#include "core/sampling.h"

/// The bounds that other tests hold random estimates to.
namespace render2mpeg::support {
namespace {

TEST(Statistics, HasTheQuantilesOfTables) {
    EXPECT_NEAR(normal_quantile_above(0.5), 0.0, 1e-9);
    EXPECT_NEAR(normal_quantile_above(0.025), 1.959964, 1e-6);
    EXPECT_NEAR(normal_quantile_above(0.005), 2.575829, 1e-6);
    EXPECT_NEAR(normal_quantile_above(1e-9), 5.997807, 1e-6);
}

TEST(Statistics, SharesAChanceAmongComparisons) {
    EXPECT_NEAR(1 - std::pow(1 - sidak(0.01, 12), 12), 0.01, 1e-12);
    EXPECT_EQ(sidak(0.01, 1), 0.01);
    EXPECT_NEAR(allowed_deviation(), 3.8895, 1e-3);
    EXPECT_GT(allowed_deviation(100), allowed_deviation(10));
}

TEST(Statistics, OfDrawsAreThoseOfTheirNumbers) {
    Draws draws;
    for (const double value : {1.0, 2.0, 3.0, 6.0}) draws.add(value);
    EXPECT_EQ(draws.count(), 4);
    EXPECT_NEAR(draws.mean(), 3.0, 1e-12);
    EXPECT_NEAR(draws.variance(), 14.0 / 3, 1e-12);
    EXPECT_NEAR(draws.standard_error(), std::sqrt(14.0 / 12), 1e-12);
}

TEST(Statistics, TellsMeansThatDifferFromChance) {
    const double z = allowed_deviation();
    EXPECT_TRUE(same_mean(1, 0.03, 1 + 0.05 * 0.99 * z, 0.04));
    EXPECT_FALSE(same_mean(1, 0.03, 1 + 0.05 * 1.01 * z, 0.04));
    EXPECT_FALSE(same_mean(1 + 0.05 * 1.01 * z, 0.03, 1, 0.04));
    EXPECT_TRUE(same_mean(1, 0.03, 1 + 0.05 * 1.01 * z, 0.04, 2));
    EXPECT_TRUE(same_mean(1, 0.03, 1 + 0.05 * 1.01 * z, 0.04, 1, 0.01));
    EXPECT_FALSE(same_mean(std::numeric_limits<double>::quiet_NaN(), 1, 1, 1));
}

TEST(Statistics, FindsMeansOfLikeDrawsAlikeAndOthersNot) {
    constexpr int n = 2000;
    int off = 0, found = 0;
    for (std::uint64_t trial = 0; trial < 400; ++trial) {
        Draws a, b, more;
        for (std::uint64_t i = 0; i < n; ++i) {
            a.add(static_cast<double>(core::uniform(1, trial, i)));
            b.add(static_cast<double>(core::uniform(2, trial, i)));
            more.add(1.1 * static_cast<double>(core::uniform(3, trial, i)));
        }
        off += same_mean(a, b) ? 0 : 1;
        found += same_mean(a, more) ? 0 : 1;
    }
    EXPECT_LE(off, 1);
    // A tenth more is 5.2 standard errors here, of which 3.9 are allowed.
    EXPECT_NEAR(found / 400.0, 0.91, 0.06);
}

TEST(Statistics, CountsHowManyDrawsMayBeOfAKind) {
    // One of a hundred draws of one in a million is likely 1e-4: not yet below the chance; two are.
    EXPECT_EQ(most_of_draws(100, 1e-6), 0);
    EXPECT_EQ(most_of_draws(102, 1e-6), 1);
    EXPECT_EQ(most_of_draws(1, 0.5), 1);
    // Many draws are normal: mean and allowed one-sided deviation.
    const int k = most_of_draws(100000, 0.1);
    EXPECT_NEAR((k - 10000) / std::sqrt(9000.0), normal_quantile_above(sidak(false_alarms, comparing_tests)), 0.05);
}

}  // namespace
}  // namespace render2mpeg::support
