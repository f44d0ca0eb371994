#include "renderer/cache/cache_validation.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::renderer {
namespace {

/// chosen: docs/measurements.md#irradiance-cache, "Hold-out validation"; the share is below what is promised.
constexpr double aimed_share = 0.007;
/// The cache error scale goes in these steps, up to one at which hardly anything is served and down to one for light
/// that is smoother than any fitted. chosen: least 0.5 of 0.3, 0.5, 0.64 and 1 (docs/measurements.md#irradiance-cache).
constexpr float step = 1.25f, least = 0.5f, most = 6.0f;
/// By how many standard deviations more points must be off than is aimed at: few say little of a hundredth.
constexpr double significance = 1.5;

/// How many points, of those served by this cache_error_scale, are off by more than they may; by how many of all were
/// served.
double count_missed(const std::vector<HeldOutPoint>& points, float cache_error_scale) {
    double count = 0;
    for (const HeldOutPoint& p : points)
        count += p.estimate * cache_error_scale <= 1.0f && p.error > 1.0f ? p.share : 0.0f;
    return count;
}

}  // namespace

void CacheValidation::learn(std::span<const HeldOutPoint> points) {
    for (const HeldOutPoint& p : points) {
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
    const float looser = std::max(cache_error_scale_ / step, least);
    if (looser < cache_error_scale_ && count_missed(points_, cache_error_scale_) < 0.5 * aimed)
        cache_error_scale_ = looser;
    while (cache_error_scale_ * step <= most && count_missed(points_, cache_error_scale_) > aimed + scatter)
        cache_error_scale_ *= step;
}

}  // namespace render2mpeg::renderer
