#pragma once
// When a cut is fine enough: the estimated error of every point is below its tolerance.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/numeric.h"
#include "core/tolerance_map.h"
#include "renderer/base/allocation.h"
#include "renderer/cut/point_light.h"
#include "renderer/tree/gather_lanes.h"
#include "renderer/tree/lane_sums.h"

namespace render2mpeg::renderer {

/// Tolerances of a group's lanes, in luminance of their pixels.
struct alignas(64) GroupTolerance {
    Lanes absolute, relative, background, base;
    Lanes root;               ///< PointTolerance::root; 0 as 1
    Lanes noise;              ///< PointTolerance::noise
    Allocation allocation{};  ///< of samples of lamps, where these have a price
    void set(int lane, const PointTolerance& t) {
        absolute[lane] = t.part.absolute;
        relative[lane] = t.part.relative;
        background[lane] = t.part.background;
        base[lane] = t.base;
        root[lane] = t.root;
        noise[lane] = t.noise;
    }
};

/// When a group's cut is fine enough: the one place that knows. Every point of the group is judged by itself, against
/// its tolerance T at the luminance so far (core::Tolerance). The cut is refined until its strictest point is
/// satisfied.
///
/// A cluster is measured by the plain upper bound B of its luminance (visible, at its best), not by eqs. 6.5-6.7 of
/// [Render2MPEG]: those are smallest where the representative is visible and bright, so that refinement avoids the
/// clusters that carry the light.
///
/// The errors of clusters are independent, since their representatives are drawn at random. So they add up as squares:
/// k sqrt(sum of B^2) <= T, where k makes of a bound the error that one pixel in a hundred exceeds. Or else q B <= T
/// for every cluster: the rule of [Walter2005, 5] at the part of the tolerance where it is as safe. It is reached first
/// where few clusters carry the light and the tolerance is fine. [Walter2005]'s own rule, B <= T, bounds single
/// clusters and not their sum: in scenes of mostly indirect light 22..49 % of pixels err by more than 2 % at 2 %.
class StoppingRule {
  public:
    /// `error_scale` multiplies the estimated error of a cut.
    void start(float error_scale, const GroupTolerance& tolerance) {
        error_scale_ = error_scale;
        for (int i = 0; i < lane_count; ++i) {
            const core::Tolerance t{tolerance.absolute[i], tolerance.relative[i], tolerance.background[i]};
            absolute_[i] = t.absolute;
            relative_[i] = t.relative;
            weber_[i] = t.weber_fraction();
            least_[i] = t.least();
            base_[i] = tolerance.base[i];
        }
    }

    /// Takes the luminance gathered so far, which moves the tolerances.
    RENDER2MPEG_ALWAYS_INLINED void observe(const Lanes& luminance) {
        for (int i = 0; i < lane_count; ++i) {
            light_[i] = inlined::max(luminance[i], 0.0f) + base_[i];
            tolerance_[i] = allowed(i, light_[i]);
            inverse_[i] = error_scale_ / inlined::max(tolerance_[i], least_tolerance);
        }
    }

    /// Refinement priority of a cluster with these bounds: the sum of their squares, in units of the points'
    /// tolerances.
    RENDER2MPEG_ALWAYS_INLINED float priority(const Lanes& bound) const {
        alignas(64) Lanes square;
        for (int i = 0; i < lane_count; ++i) {
            const float of_tolerance = bound[i] * inverse_[i];
            const float ratio = of_tolerance < largest_ratio ? of_tolerance : largest_ratio;
            square[i] = ratio * ratio;
        }
        return sum_of(square);
    }

    /// Below this priority a cluster's bounds are a safe part of what `lanes` points tolerate, in the mean.
    static float safe_priority(int lanes) { return static_cast<float>(lanes) / (safe_part * safe_part); }

    /// Whether no lane's estimated error exceeds its tolerance. Asks the lane first that exceeded it last.
    bool satisfied(const double (&sum_of_squares)[lane_count]) {
        for (int n = 0; n < lane_count; ++n) {
            const int lane = (strictest_ + n) % lane_count;
            if (!exceeds(sum_of_squares[lane], lane)) continue;
            strictest_ = lane;
            return false;
        }
        return true;
    }

    /// Whether a cluster with these bounds is limiting: it alone is too large for a lane that the sum of squares does
    /// not satisfy.
    bool is_limiting(const Lanes& bound, const double (&sum_of_squares)[lane_count]) const {
        for (int i = 0; i < lane_count; ++i)
            if (safe_part * bound[i] * inverse_[i] > 1.0f && exceeds(sum_of_squares[i], i)) return true;
        return false;
    }

    /// Bit i: the estimated error of lane i exceeds its tolerance; `largest` are the lanes' largest bounds.
    std::uint32_t broken(const double (&sum_of_squares)[lane_count], const Lanes& largest) const {
        std::uint32_t lanes = 0;
        for (int i = 0; i < lane_count; ++i)
            lanes |= error(i, sum_of_squares[i], largest[i]) > tolerance_[i] ? 1u << i : 0u;
        return lanes;
    }

    /// Estimated error of a lane in luminance, from its sum of squared bounds and its largest bound.
    float error(int lane, double sum_of_squares, float largest) const {
        const auto summed = static_cast<float>(scale(lane) * std::sqrt(std::max(sum_of_squares, 0.0)));
        return std::min(summed, error_scale_ * safe_part * largest);
    }

    /// k of a lane. fit: docs/measurements.md#stopping-rule. It falls as the relative tolerance t = T over the light
    /// grows, since the bounds of coarse clusters are looser: coarse + (fine - coarse) / (1 + (t / t0)^2).
    float scale(int lane) const {
        float t = tolerance_[lane] > 0.0f ? loosest : 0.0f;
        if (light_[lane] > 0.0f) t = std::min(loosest, tolerance_[lane] / light_[lane]);
        return error_scale_ * (coarse_scale + (fine_scale - coarse_scale) * turn2 / (turn2 + t * t));
    }

  private:
    /// core::Tolerance::allows.
    RENDER2MPEG_ALWAYS_INLINED float allowed(int lane, float light) const {
        const float absolute = inlined::max(least_[lane], inlined::min(absolute_[lane], weber_[lane] * light));
        return inlined::max(relative_[lane] * light, absolute);
    }
    bool exceeds(double sum_of_squares, int lane) const {
        const double k = scale(lane), tolerance = tolerance_[lane];
        return k * k * sum_of_squares > tolerance * tolerance;
    }

    /// Stands for no tolerance at all; any bound that matters is larger.
    static constexpr float least_tolerance = 1e-30f;
    /// Keeps squares of what is beyond any measure finite.
    static constexpr float largest_ratio = 1e15f;
    /// q. fit: docs/measurements.md#stopping-rule, "classic": 7.24 over its scenes, with one light per cluster.
    static constexpr float safe_part = 7.0f;
    static constexpr float fine_scale = 0.62f, coarse_scale = 0.36f, turn2 = 0.08f * 0.08f;
    static constexpr float loosest = 1e6f;

    float error_scale_ = 1;
    int strictest_ = 0;
    alignas(64) Lanes absolute_{}, relative_{}, weber_{}, least_{}, base_{}, light_{}, tolerance_{}, inverse_{};
};

}  // namespace render2mpeg::renderer
