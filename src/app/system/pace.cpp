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
    // fit: bench/fits/forecast.jsonl: a B picture takes 0.4 to 0.6 of a P picture, of which there are two in five.
    constexpr double mean_over_b = 1.45;
    if (takes_turns_ && later_.size() == 1) return mean_over_b * later_.front();
    // fit: bench/fits/forecast.jsonl: the later half of what is known, 4 to 24 frames in whole rounds of a P picture
    // with its B pictures, which take half as long: what is kept makes frames cheaper at first, and films change after
    // a second.
    const std::size_t most = (std::clamp<std::size_t>((later_.size() + 1) / 2, 4, 24) + 3) / 4 * 4;
    std::vector<double> last(later_.end() - static_cast<std::ptrdiff_t>(std::min(later_.size(), most)), later_.end());
    std::vector<double> sorted = last;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    // One frame that takes much longer is not what is to come.
    for (double& seconds : last)
        if (seconds > 4 * *middle) seconds = *middle;
    const auto mean = [](auto begin, auto end) {
        return std::accumulate(begin, end, 0.0) / static_cast<double>(end - begin);
    };
    // Where light stands still, the last frames tell.
    const auto half = last.begin() + static_cast<std::ptrdiff_t>(last.size() / 2);
    if (last.size() >= 4 && mean(half, last.end()) < 0.5 * mean(last.begin(), half)) return mean(half, last.end());
    return mean(last.begin(), last.end());
}

std::optional<double> Pace::left(std::int64_t total, double spent) const {
    if (done_ >= total) return 0.0;
    // fit: bench/fits/forecast.jsonl: of ten films' later frames over their first one 0.3 to 0.9.
    constexpr double later_over_first = 0.6;
    double first = first_count_ > 0 ? firsts_ / first_count_ : recent();
    // Of a first frame nothing is known but what it took: half of it, as likely as not.
    if (first <= 0) first = 2 * spent;
    if (first <= 0) return {};
    const double later = later_.empty() && chunk_ > 0 ? later_over_first * first : later_.empty() ? first : recent();
    std::int64_t firsts = 0;
    if (chunk_ > 0) firsts = (total + chunk_ - 1) / chunk_ - (done_ + chunk_ - 1) / chunk_;
    const double all = static_cast<double>(firsts) * first + static_cast<double>(total - done_ - firsts) * later;
    // A frame that takes longer than it should is not done at once.
    const double at_hand = is_first(done_) ? first : later;
    return all - at_hand + std::max(at_hand - spent, 0.2 * std::max(at_hand, spent));
}

double Pace::per_second() const {
    const double seconds = recent();
    return seconds > 0 ? 1 / seconds : 0;
}

}  // namespace render2mpeg::app
