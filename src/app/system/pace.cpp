#include "app/system/pace.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

/// Frames of a kind, and rounds, that tell of those to come. chosen: 24 (12 to 48).
constexpr std::ptrdiff_t recent = 24;

/// What the first frame of a kind takes beyond the late ones, of its time. fit: eleven films of animations/ in 96x54
/// to 192x108 (tests/pipeline/pace_test.cpp has six of them).
constexpr double surplus_of_b = 0.3, surplus_of_others = 0.12;

/// The least of what is expected, of the mean so far: a fall does not go on for ever. chosen: a fifth.
constexpr double least = 0.2;

/// Mean seconds of the next `count` frames of a kind. The k-th takes a + b / k: kept light is found in the first ones.
double expected(const std::vector<double>& seconds, double count, double surplus) {
    const auto known = static_cast<double>(seconds.size());
    count = std::max(count, 1.0);
    const double next = std::log((known + count + 0.5) / (known + 0.5)) / count;  // mean of 1 / k
    if (seconds.size() == 1) return seconds[0] * (1 - surplus + surplus * next);
    const std::size_t first = seconds.size() - static_cast<std::size_t>(std::min(recent, std::ssize(seconds)));
    const double used = known - static_cast<double>(first);
    double mean = 0, mean_share = 0, slope = 0, spread = 0;
    for (std::size_t k = first; k < seconds.size(); ++k) {
        mean += seconds[k] / used;
        mean_share += 1 / (static_cast<double>(k + 1) * used);
    }
    for (std::size_t k = first; k < seconds.size(); ++k) {
        const double share = 1 / static_cast<double>(k + 1) - mean_share;
        slope += share * (seconds[k] - mean);
        spread += share * share;
    }
    // Times that rise do so for other reasons.
    const double b = std::max(core::divide_or(slope, spread, 0.0), 0.0);
    return std::max(mean + b * (next - mean_share), least * mean);
}

}  // namespace

void Pace::add(double seconds, char type) {
    if (firsts_from(done_, done_ + 1) > 0) {
        first_seconds_ += seconds;
        ++first_count_;
        run_ = 0;
    } else if (type == 'B') {
        b_.push_back(seconds);
        ++run_;
    } else {
        others_.push_back(seconds);
        rounds_.push_back(std::exchange(run_, 0) + 1);
    }
    ++done_;
}

std::int64_t Pace::firsts_from(std::int64_t frame, std::int64_t total) const {
    return std::lower_bound(firsts_.begin(), firsts_.end(), total) -
           std::lower_bound(firsts_.begin(), firsts_.end(), frame);
}

double Pace::share_of_b() const {
    if (b_.empty()) return 0;
    // Before the first round ends, runs of one to three B pictures are as likely.
    if (rounds_.empty()) return 1 - 1 / (2.5 + 0.5 * run_);
    const auto used = std::min((std::ssize(rounds_) + 1) / 2, recent);
    return 1 - static_cast<double>(used) / std::accumulate(rounds_.end() - used, rounds_.end(), 0.0);
}

double Pace::later(double frames) const {
    const double first = core::divide_or(first_seconds_, static_cast<double>(first_count_), 0.0);
    const double share = share_of_b();
    const double b = b_.empty() ? 0 : expected(b_, share * frames, surplus_of_b);
    if (!others_.empty()) return share * b + (1 - share) * expected(others_, (1 - share) * frames, surplus_of_others);
    // fit: as above; a P picture lies between first frames and B pictures, by factors.
    if (!b_.empty())
        return share * b + (1 - share) * (first > 0 ? (1 - surplus_of_others) * std::sqrt(first * b_.back()) : 2 * b);
    constexpr double later_over_first = 0.6;
    return later_over_first * first;
}

std::optional<double> Pace::left(std::int64_t total, double spent) const {
    if (done_ >= total) return 0.0;
    const auto firsts = firsts_from(done_, total);
    const double known = core::divide_or(first_seconds_, static_cast<double>(first_count_), 0.0);
    double rest = later(static_cast<double>(total - done_ - firsts));
    // Of a first frame half is done, as likely as not.
    const double first = known > 0 ? known : rest > 0 ? rest : 2 * spent;
    if (first <= 0) return {};
    constexpr double later_over_first = 0.6;
    if (rest <= 0) rest = firsts_.empty() ? first : later_over_first * first;
    const double all = static_cast<double>(firsts) * first + static_cast<double>(total - done_ - firsts) * rest;
    // A slow frame is not done at once.
    const double at_hand = firsts_from(done_, done_ + 1) > 0 ? first : rest;
    return all - at_hand + std::max(at_hand - spent, 0.2 * std::max(at_hand, spent));
}

double Pace::per_second() const {
    return b_.empty() && others_.empty() ? 0 : core::divide_or(1.0, later(1), 0.0);
}

}  // namespace render2mpeg::app
