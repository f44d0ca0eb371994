#include "app/system/error_histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace render2mpeg::app {

void ErrorHistogram::add(float error) {
    const float above = (std::log2(error) - static_cast<float>(least_exponent)) * static_cast<float>(per_doubling);
    // 0 lands in the first step, NaN beyond the last.
    std::size_t step = steps + 1;
    if (above <= static_cast<float>(steps)) step = static_cast<std::size_t>(std::max(std::ceil(above), 0.0f));
    ++counts_[step];
    ++count_;
}

void ErrorHistogram::add(const ErrorHistogram& others) {
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += others.counts_[i];
    count_ += others.count_;
}

double ErrorHistogram::quantile(double q) const {
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

void ErrorHistogram::restore(const std::vector<std::uint64_t>& counts) {
    counts_.fill(0);
    if (counts.size() == counts_.size()) std::copy(counts.begin(), counts.end(), counts_.begin());
    count_ = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

}  // namespace render2mpeg::app
