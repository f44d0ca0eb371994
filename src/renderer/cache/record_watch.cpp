#include "renderer/cache/record_watch.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::renderer {
namespace {

/// chosen: docs/fits/records.md, "Hold-out validation"; the share is below what is promised.
constexpr double aimed_share = 0.007;
/// Strictness goes in these steps, up to one at which hardly anything is served and down to where light is smoother
/// than trust is made for. chosen: least 0.5 of 0.3, 0.5, 0.64 and 1 (docs/fits/records.md).
constexpr float step = 1.25f, least = 0.5f, most = 6.0f;
/// By how many standard deviations more points must be off than is aimed at: few say little of a hundredth.
constexpr double significance = 1.5;

/// How many points, of those served by this strictness, are off by more than they may; by how many of all were served.
double off(const std::vector<WatchedPoint>& points, float strictness) {
    double count = 0;
    for (const WatchedPoint& p : points) count += p.doubt * strictness <= 1.0f && p.miss > 1.0f ? p.share : 0.0f;
    return count;
}

}  // namespace

void RecordWatch::learn(std::span<const WatchedPoint> points) {
    for (const WatchedPoint& p : points) {
        if (points_.size() < window)
            points_.push_back(p);
        else
            points_[next_] = p;
        next_ = (next_ + 1) % window;
    }
    if (points.empty() || !knows()) return;
    const double aimed = aimed_share * static_cast<double>(points_.size()), scatter = significance * std::sqrt(aimed);
    // Looser than now tells nothing: who would be served then was not. So one step back at a time, and only where there
    // is room.
    const float looser = std::max(strictness_ / step, least);
    if (looser < strictness_ && off(points_, strictness_) < 0.5 * aimed) strictness_ = looser;
    while (strictness_ * step <= most && off(points_, strictness_) > aimed + scatter) strictness_ *= step;
}

}  // namespace render2mpeg::renderer
