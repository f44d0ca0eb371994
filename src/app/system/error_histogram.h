#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace render2mpeg::app {

/// Counts of errors by size, in even steps of their logarithm: as large for an hour of film as for a frame.
class ErrorHistogram {
  public:
    /// error >= 0; what is not a number counts as infinite.
    void add(float error);

    void add(const ErrorHistogram& others);

    std::uint64_t count() const { return count_; }

    /// The error that a share `q` (0..1) of all does not exceed: rounded up by at most 1.1 %. 0 up to 2^-24, and
    /// without any errors; infinity above 256: how large is not known.
    double quantile(double q) const;

    /// Counts by step, for who stores them.
    std::vector<std::uint64_t> counts() const { return {counts_.begin(), counts_.end()}; }
    /// Takes what counts() gave, and drops what it had. Another number of steps leaves it empty.
    void restore(const std::vector<std::uint64_t>& counts);

  private:
    /// chosen: 64 steps per doubling, from 2^-24 (a float's last digit) to 2^8; beyond that, how large does not matter.
    static constexpr int per_doubling = 64, least_exponent = -24, largest_exponent = 8;
    static constexpr std::size_t steps = per_doubling * (largest_exponent - least_exponent);

    std::array<std::uint64_t, steps + 2> counts_{};  ///< [0]: up to the least, [steps + 1]: above the largest
    std::uint64_t count_ = 0;
};

}  // namespace render2mpeg::app
