#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace render2mpeg::app {

/// Histogram of errors in even steps of their logarithm.
class ErrorHistogram {
  public:
    /// error >= 0; NaN counts as infinite.
    void add(float error);

    void add(const ErrorHistogram& others);

    std::uint64_t count() const { return count_; }

    /// Quantile `q` (0..1), rounded up by at most 1.1 %: 0 up to 2^-24 and without errors, infinity above 256.
    double quantile(double q) const;

    std::vector<std::uint64_t> counts() const { return {counts_.begin(), counts_.end()}; }
    /// Restores counts(); another number of steps leaves it empty.
    void restore(const std::vector<std::uint64_t>& counts);

  private:
    /// chosen: 64 steps per doubling, from 2^-24 (a float's last digit) to 2^8; beyond that, how large does not matter.
    static constexpr int per_doubling = 64, least_exponent = -24, largest_exponent = 8;
    static constexpr std::size_t steps = per_doubling * (largest_exponent - least_exponent);

    std::array<std::uint64_t, steps + 2> counts_{};  ///< [0]: up to the least, [steps + 1]: above the largest
    std::uint64_t count_ = 0;
};

}  // namespace render2mpeg::app
