#include "core/binomial.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render2mpeg::core {
namespace {

TEST(Binomial, BoundsAreThoseOfClosedForms) {
    // None of n: the share whose chance to be missed n times is 5 %; all but one: its complement.
    for (const int n : {1, 10, 59, 1000}) {
        EXPECT_NEAR(most_share(0, n, 0.95), 1 - std::pow(0.05, 1.0 / n), 1e-9) << n;
        EXPECT_NEAR(most_share(n - 1, n, 0.95), std::pow(0.95, 1.0 / n), 1e-9) << n;
    }
    EXPECT_EQ(most_share(0, 0, 0.95), 1);
    EXPECT_EQ(most_share(7, 7, 0.95), 1);
}

TEST(Binomial, BoundsAreThoseOfTheIncompleteBetaFunction) {
    // Sums of the distribution's terms in 60 digits: the beta distribution's quantile at marked + 1, drawn - marked.
    EXPECT_NEAR(most_share(2, 1000, 0.95), 0.00628228455, 1e-9);
    EXPECT_NEAR(most_share(13, 80, 0.95), 0.24588983227, 1e-9);
    EXPECT_NEAR(most_share(5000, 100000, 0.95), 0.05114832195, 1e-9);
    EXPECT_NEAR(most_share(13, 80, 0.99), 0.28087533061, 1e-9);
}

}  // namespace
}  // namespace render2mpeg::core
