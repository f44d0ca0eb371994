#include "app/system/pace.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace render2mpeg::app {

void Pace::add(double seconds) {
    if (is_first(done_)) {
        firsts_ += seconds;
        ++first_count_;
    } else {
        later_.push_back(seconds);
    }
    ++done_;
}

double Pace::recent() const {
    if (later_.empty()) return 0;
    // chosen: the later half of what is known, 3 to 24 frames: what is kept makes frames cheaper at first, and films
    // change after a second. The records of tests/pipeline/pace_test.cpp were looked at.
    const std::size_t most = std::clamp<std::size_t>((later_.size() + 1) / 2, 3, 24);
    std::vector<double> last(later_.end() - static_cast<std::ptrdiff_t>(std::min(later_.size(), most)), later_.end());
    const double mean = std::accumulate(last.begin(), last.end(), 0.0) / static_cast<double>(last.size());
    // One frame that takes longer is not what is to come.
    const auto middle = last.begin() + static_cast<std::ptrdiff_t>(last.size() / 2);
    std::nth_element(last.begin(), middle, last.end());
    return std::min(mean, *middle);
}

std::optional<double> Pace::left(std::int64_t total) const {
    if (done_ >= total) return 0.0;
    if (later_.empty() && chunk_ != 1) return {};
    const double first = first_count_ > 0 ? firsts_ / first_count_ : recent();
    std::int64_t firsts = 0;
    if (chunk_ > 0) firsts = (total + chunk_ - 1) / chunk_ - (done_ + chunk_ - 1) / chunk_;
    return static_cast<double>(firsts) * first + static_cast<double>(total - done_ - firsts) * recent();
}

double Pace::per_second() const {
    const double seconds = recent();
    return seconds > 0 ? 1 / seconds : 0;
}

}  // namespace render2mpeg::app
