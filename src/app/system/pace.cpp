#include "app/system/pace.h"

#include <algorithm>
#include <numeric>

#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

/// Later frames that tell of those to come. chosen: 8, two rounds of B pictures (8, 16, 24:
/// tests/pipeline/pace_test.cpp).
constexpr std::size_t recent = 8;

/// Later frames over those that begin light, where only these are known. chosen: 0.6.
constexpr double later_over_first = 0.6;

}  // namespace

void Pace::add(double seconds) {
    if (firsts_from(done_, done_ + 1) > 0) {
        first_seconds_ += seconds;
        ++first_count_;
    } else {
        recent_.push_back(seconds);
        if (recent_.size() > recent) recent_.pop_front();
    }
    ++done_;
}

std::int64_t Pace::firsts_from(std::int64_t frame, std::int64_t total) const {
    return std::lower_bound(firsts_.begin(), firsts_.end(), total) -
           std::lower_bound(firsts_.begin(), firsts_.end(), frame);
}

double Pace::later() const {
    return core::divide_or(std::accumulate(recent_.begin(), recent_.end(), 0.0), static_cast<double>(recent_.size()),
                           0.0);
}

std::optional<double> Pace::left(std::int64_t total, double spent) const {
    if (done_ >= total) return 0.0;
    const auto firsts = firsts_from(done_, total);
    const double known = core::divide_or(first_seconds_, static_cast<double>(first_count_), 0.0);
    // Of a first frame half is done, as likely as not.
    const double first = known > 0 ? known : later() > 0 ? later() : 2 * spent;
    if (first <= 0) return {};
    const double rest = later() > 0 ? later() : firsts_.empty() ? first : later_over_first * first;
    const double all = static_cast<double>(firsts) * first + static_cast<double>(total - done_ - firsts) * rest;
    // A slow frame is not done at once.
    const double at_hand = firsts_from(done_, done_ + 1) > 0 ? first : rest;
    return all - at_hand + std::max(at_hand - spent, 0.2 * std::max(at_hand, spent));
}

double Pace::per_second() const {
    return core::divide_or(1.0, later(), 0.0);
}

}  // namespace render2mpeg::app
