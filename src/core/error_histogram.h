#pragma once
// A histogram of errors.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace render2mpeg::core {

/// Histogram of errors in even steps of their logarithm.
class ErrorHistogram {
  public:
    /// error >= 0; NaN counts as infinite.
    void add(float error) {
        const float above = (std::log2(error) - static_cast<float>(least_exponent)) * static_cast<float>(per_doubling);
        // 0 lands in the first step, NaN beyond the last.
        std::size_t step = steps + 1;
        if (above <= static_cast<float>(steps)) step = static_cast<std::size_t>(std::max(std::ceil(above), 0.0f));
        ++counts_[step];
        ++count_;
    }

    void add(const ErrorHistogram& others) {
        for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += others.counts_[i];
        count_ += others.count_;
    }

    std::uint64_t count() const { return count_; }

    /// Quantile `q` (0..1), rounded up by at most 1.1 %: 0 up to 2^-24 and without errors, infinity above 256.
    double quantile(double q) const {
        const double wanted = std::max(q * static_cast<double>(count_), 1.0);
        std::uint64_t sum = 0;
        for (std::size_t step = 0; step < counts_.size(); ++step) {
            sum += counts_[step];
            if (static_cast<double>(sum) < wanted) continue;
            if (step > steps) return std::numeric_limits<double>::infinity();
            return step == 0 ? 0.0 : std::exp2(static_cast<double>(step) / per_doubling + least_exponent);
        }
        return 0.0;
    }

    std::vector<std::uint64_t> counts() const { return {counts_.begin(), counts_.end()}; }
    /// Restores counts(); another number of steps leaves it empty.
    void restore(const std::vector<std::uint64_t>& counts) {
        counts_.fill(0);
        if (counts.size() == counts_.size()) std::ranges::copy(counts, counts_.begin());
        count_ = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
    }

  private:
    /// chosen: 64 steps per doubling, from 2^-24 (a float's last digit) to 2^8; beyond that, how large does not matter.
    static constexpr int per_doubling = 64, least_exponent = -24, largest_exponent = 8;
    static constexpr std::size_t steps = per_doubling * (largest_exponent - least_exponent);

    std::array<std::uint64_t, steps + 2> counts_{};  ///< [0]: up to the least, [steps + 1]: above the largest
    std::uint64_t count_ = 0;
};

}  // namespace render2mpeg::core
