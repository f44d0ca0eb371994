#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

/// Bounds for random estimates, that follow from the estimates' own spread and a chance of false alarms: another
/// machine rounds otherwise, so that all numbers are drawn anew there.
namespace render2mpeg::support {

/// The chance that any of all tests that compare random estimates fails on a machine though all of them are right.
inline constexpr double false_alarms = 0.01;
/// How many such tests share it, about.
inline constexpr int comparing_tests = 100;

/// What each of n independent comparisons may fail by chance, if all together may by `chance`. [Sidak1967]
inline double sidak(double chance, int comparisons) {
    return -std::expm1(std::log1p(-chance) / comparisons);
}

/// The value that a standard normal variable exceeds with probability `chance`, in (0, 0.5].
inline double normal_quantile_above(double chance) {
    double low = 0, high = 38;
    for (int i = 0; i < 80; ++i) {
        const double middle = (low + high) / 2;
        (std::erfc(middle / std::sqrt(2.0)) / 2 > chance ? low : high) = middle;
    }
    return high;
}

/// Standard errors that a test with so many two-sided comparisons allows each of them.
inline double allowed_deviation(int comparisons = 1) {
    return normal_quantile_above(sidak(sidak(false_alarms, comparing_tests), comparisons) / 2);
}

/// Mean and spread of independent draws.
class Draws {
  public:
    void add(double value) {
        ++count_;
        const double off = value - mean_;
        mean_ += off / count_;
        squares_ += off * (value - mean_);
    }
    double count() const { return count_; }
    double mean() const { return mean_; }
    /// Of one draw.
    double variance() const { return squares_ / std::max(1.0, count_ - 1); }
    /// Of their mean.
    double standard_error() const { return std::sqrt(variance() / std::max(1.0, count_)); }

  private:
    double count_ = 0, mean_ = 0, squares_ = 0;
};

/// A Z-test of one of a test's `comparisons`: whether two means, known to these standard errors, differ by no more than
/// chance and `bias`, which is known of them.
inline testing::AssertionResult same_mean(double a, double error_of_a, double b, double error_of_b, int comparisons = 1,
                                          double bias = 0) {
    const double allowed = bias + allowed_deviation(comparisons) * std::hypot(error_of_a, error_of_b);
    // Not a number is no mean.
    if (std::abs(a - b) <= allowed) return testing::AssertionSuccess();
    return testing::AssertionFailure() << a << " +- " << error_of_a << " and " << b << " +- " << error_of_b
                                       << " differ by " << std::abs(a - b) << ", by chance at most " << allowed;
}

inline testing::AssertionResult same_mean(const Draws& a, const Draws& b, int comparisons = 1, double bias = 0) {
    return same_mean(a.mean(), a.standard_error(), b.mean(), b.standard_error(), comparisons, bias);
}

/// How many of n independent draws may be of a kind that has this probability: more are by chance as likely as one of
/// `comparisons` of a test may be.
inline int most_of_draws(int n, double probability, int comparisons = 1) {
    const double chance = sidak(sidak(false_alarms, comparing_tests), comparisons);
    // Add what is likely from the least number upwards, until what remains is below the chance.
    double remains = 1;
    for (int k = 0; k < n; ++k) {
        const double log_of_ways = std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
        remains -= std::exp(log_of_ways + k * std::log(probability) + (n - k) * std::log1p(-probability));
        if (remains < chance) return k;
    }
    return n;
}

}  // namespace render2mpeg::support
