#include "app/system/pace.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "core/numeric.h"

namespace render2mpeg::app {

void Pace::add(double seconds, double made) {
    if (is_first(done_)) {
        firsts_ += seconds;
        made_first_ += made;
        ++first_count_;
    } else {
        later_.push_back({seconds, made});
    }
    ++done_;
}

double Pace::per_record() const {
    double seconds = 0, made = 0, squares = 0, products = 0;
    for (const Frame& f : later_) seconds += f.seconds, made += f.made;
    const auto count = static_cast<double>(std::max<std::size_t>(1, later_.size()));
    for (const Frame& f : later_) {
        squares += (f.made - made / count) * (f.made - made / count);
        products += (f.made - made / count) * (f.seconds - seconds / count);
    }
    // The slope of a line through the frames. A chunk's first takes more for other reasons too: no record takes more
    // than its share of that.
    const double most = core::divide_or(firsts_, made_first_, 0.0);
    return std::clamp(core::divide_or(products, squares, most), 0.0, most);
}

double Pace::recent() const {
    if (later_.empty()) return 0;
    // chosen: the later half of what is known, 3 to 24 frames: what is kept makes frames cheaper at first, and films
    // change after a second. The records of tests/pipeline/pace_test.cpp were looked at.
    const std::size_t most = std::clamp<std::size_t>((later_.size() + 1) / 2, 3, 24);
    const std::size_t count = std::min(later_.size(), most);
    const double each = per_record();
    std::vector<double> last;
    for (std::size_t i = later_.size() - count; i < later_.size(); ++i)
        last.push_back(std::max(0.0, later_[i].seconds - each * later_[i].made));
    const double mean = std::accumulate(last.begin(), last.end(), 0.0) / static_cast<double>(count);
    // One frame that takes longer is not what is to come.
    std::nth_element(last.begin(), last.begin() + static_cast<std::ptrdiff_t>(count / 2), last.end());
    return std::min(mean, last[count / 2]);
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
