#include "encoder/rate_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

/// Bits are reached in few tries.
namespace render2mpeg::encoder {
namespace {

struct Outcome {
    double ratio = std::numeric_limits<double>::infinity();  ///< of the best try
    int tries = 0;
};

Outcome search(const std::function<double(double)>& ratio_with) {
    Outcome outcome;
    for (RateSearch search; search.goes_on(); ++outcome.tries) {
        const double ratio = ratio_with(search.factor());
        const bool nearer = std::abs(std::log(ratio)) < std::abs(std::log(outcome.ratio));
        EXPECT_EQ(search.try_ratio(ratio), nearer);
        if (nearer) outcome.ratio = ratio;
    }
    return outcome;
}

TEST(RateSearch, ReachesBitsThatFallWithAnyPowerOfTheQuantiser) {
    for (const double slope : {0.4, 0.7, 0.9, 1.3, 2.0})
        for (const double first : {0.1, 0.5, 0.98, 1.7, 12.0}) {
            const Outcome outcome = search([&](double factor) { return first * std::pow(factor, -slope); });
            EXPECT_NEAR(outcome.ratio, 1, 0.0051) << slope << ", " << first;
            EXPECT_LE(outcome.tries, 8);
        }
}

TEST(RateSearch, ReachesBitsThatHaveAFloor) {
    for (const double floor : {0.1, 0.5, 0.9}) {
        const Outcome outcome = search([&](double factor) { return floor + 3 * std::pow(factor, -1.5); });
        EXPECT_NEAR(outcome.ratio, 1, 0.0051) << floor;
    }
}

TEST(RateSearch, TakesTheNearestOfWholeSteps) {
    for (const double first : {0.3, 0.9, 1.1, 2.5}) {
        const auto ratio_of_step = [&](double step) { return first * std::pow(2, -step / 9.6); };
        double nearest = std::numeric_limits<double>::infinity();
        for (int step = -40; step <= 40; ++step)
            if (std::abs(std::log(ratio_of_step(step))) < std::abs(std::log(nearest))) nearest = ratio_of_step(step);
        const Outcome outcome =
            search([&](double factor) { return ratio_of_step(std::round(9.6 * std::log2(factor))); });
        // One within half a per cent will do.
        EXPECT_NEAR(outcome.ratio, nearest, 0.0101) << first;
    }
}

TEST(RateSearch, EndsWhereTheScaleEnds) {
    const Outcome outcome = search([](double factor) { return 4 / std::clamp(factor, 0.5, 2.0); });
    EXPECT_EQ(outcome.ratio, 2);
    EXPECT_LE(outcome.tries, 5);
}

TEST(RateSearch, GoesOnWithTheSlopeThatItFound) {
    const auto fast = [](double factor) { return 3 * std::pow(factor, -1.6); };
    const auto own = [&](double factor) { return 0.8 * fast(factor); };
    RateSearch roughly(0.05, 5);
    while (roughly.goes_on()) roughly.try_ratio(fast(roughly.factor()));
    RateSearch search = roughly.onwards(0.01, 8);
    double ratio = 0;
    int tries = 0;
    for (; search.goes_on(); ++tries) search.try_ratio(ratio = own(search.factor()));
    EXPECT_NEAR(ratio, 1, 0.01);
    EXPECT_LE(tries, 2) << "one tells what efforts differ by, one meets it";
}

}  // namespace
}  // namespace render2mpeg::encoder
