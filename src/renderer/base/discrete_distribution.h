#pragma once
// Chooses one of many in proportion to weights.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/numeric.h"

namespace render2mpeg::renderer {

class DiscreteDistribution {
  public:
    void add(double weight) { sums_.push_back(total() + weight); }
    /// Of all weights.
    double total() const { return sums_.empty() ? 0.0 : sums_.back(); }
    /// Which one a number in [0, 1) falls to; there is one at least.
    std::size_t pick(double number) const {
        const auto found = std::upper_bound(sums_.begin(), sums_.end(), number * total());
        return std::min(static_cast<std::size_t>(found - sums_.begin()), sums_.size() - 1);
    }
    /// Where the number that falls to `i` lies among those that do, in [0, 1).
    double within(std::size_t i, double number) const {
        const double first = i > 0 ? sums_[i - 1] : 0.0;
        constexpr double last = 1.0 - 0x1p-24;
        return std::clamp(core::divide_or(number * total() - first, sums_[i] - first, 0.0), 0.0, last);
    }
    double chance(std::size_t i) const {
        return core::divide_or(sums_[i] - (i > 0 ? sums_[i - 1] : 0.0), total(), 0.0);
    }

  private:
    std::vector<double> sums_;  ///< up to each, rising
};

}  // namespace render2mpeg::renderer
