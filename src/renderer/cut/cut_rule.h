#pragma once
// The stopping rules' tolerances and bounds for a group of points.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/numeric.h"
#include "renderer/base/stop.h"
#include "renderer/cut/point_light.h"
#include "renderer/tree/gather_lanes.h"
#include "renderer/tree/lane_sums.h"

namespace render2mpeg::renderer {

/// Tolerances of a group's lanes, in luminance of their pixels.
struct alignas(64) GroupTolerance {
    Lanes absolute, relative, usual, base;
    void set(int lane, const PointTolerance& t) {
        absolute[lane] = t.part.absolute;
        relative[lane] = t.part.relative;
        usual[lane] = t.part.usual;
        base[lane] = t.base;
    }
};

/// When a group's cut is fine enough: the one place that knows. Every point of the group is judged by itself, against
/// its tolerance T at the luminance so far (core::Tolerance), and the group refines on until its strictest point is
/// satisfied.
///
/// Both rules measure a cluster by the plain upper bound B of its luminance (visible, at its best), not by
/// eqs. 6.5-6.7 of [Render2MPEG]: those are smallest where the representative is visible and bright, so that refinement
/// avoids the clusters that carry the light.
///
/// Classic [Walter2005, 5]: no cluster's B exceeds T. It bounds single clusters, not their sum: in scenes of mostly
/// indirect light 22..49 % of pixels err by more than 2 % at 2 %.
///
/// Honest: the errors of clusters are independent, since their representatives are chosen by dice, so they add up as
/// squares: k sqrt(sum of B^2) <= T, where k makes of a bound what clusters err by in truth, at the hundredth pixel. Or
/// else q B <= T for every cluster: the classic rule at the part of the tolerance where it is as safe, which is reached
/// first where few clusters carry the light and the tolerance is fine.
class CutRule {
  public:
    /// `error_scale` multiplies what a cut is thought to err by.
    void start(Stop stop, float error_scale, const GroupTolerance& tolerance) {
        stop_ = stop;
        error_scale_ = error_scale;
        for (int i = 0; i < lane_count; ++i) {
            const core::Tolerance t{tolerance.absolute[i], tolerance.relative[i], tolerance.usual[i]};
            absolute_[i] = t.absolute;
            relative_[i] = t.relative;
            share_[i] = t.share();
            least_[i] = t.least();
            base_[i] = tolerance.base[i];
            lowest_[i] = largest_share;
        }
    }

    Stop stop() const { return stop_; }

    /// Takes the luminance gathered so far, which moves the tolerances.
    RENDER2MPEG_ALWAYS_INLINED void observe(const Lanes& luminance) {
        for (int i = 0; i < lane_count; ++i) {
            light_[i] = inlined::max(luminance[i], 0.0f) + base_[i];
            tolerance_[i] = allowed(i, light_[i]);
            inverse_[i] = error_scale_ / inlined::max(tolerance_[i], least_tolerance);
            lowest_[i] = inlined::min(lowest_[i], inverse_[i]);
        }
    }

    /// By what the priority of any cluster may have risen, at most, since it was asked for in this cut.
    float risen() const {
        float most = 1.0f;
        // A lane that once tolerated everything tells nothing of how far it rose since.
        for (int i = 0; i < lane_count; ++i)
            if (inverse_[i] > 0.0f)
                most = std::max(most, core::divide_or(inverse_[i], lowest_[i], std::numeric_limits<float>::max()));
        return most;
    }

    /// What a lane tolerates where this is all that it receives.
    float tolerance(int lane, float luminance) const { return allowed(lane, std::max(luminance, 0.0f) + base_[lane]); }

    /// How urgently a cluster with these bounds wants to be refined. Classic: the largest bound in units of the point's
    /// tolerance; honest: the sum of their squares.
    RENDER2MPEG_ALWAYS_INLINED float priority(const Lanes& bound) const {
        alignas(64) Lanes share, square;
        for (int i = 0; i < lane_count; ++i) {
            const float of_tolerance = bound[i] * inverse_[i];
            share[i] = of_tolerance < largest_share ? of_tolerance : largest_share;
            square[i] = share[i] * share[i];
        }
        return stop_ == Stop::classic ? largest_of(share) : sum_of(square);
    }

    /// Whether a cluster of this priority may decide how far a cut is refined. chosen, honest: bounds of a hundredth of
    /// the tolerance in one lane, of which a thousand come to a tenth of it in square.
    bool matters(float priority) const { return stop_ == Stop::classic ? !accepts(priority) : priority > 1e-4f; }

    /// Classic: whether a cluster of this priority may stay as it is.
    static bool accepts(float priority) { return priority <= 1.0f; }

    /// Classic: marks the lanes whose own tolerance this cluster breaks.
    std::uint32_t broken(const Lanes& bound) const {
        std::uint32_t lanes = 0;
        for (int i = 0; i < lane_count; ++i) lanes |= bound[i] * inverse_[i] > 1.0f ? 1u << i : 0u;
        return lanes;
    }

    /// Honest: whether no lane's estimated error exceeds its tolerance; `squares` are the sums of B^2. Asks the lane
    /// first that was in the way last.
    bool satisfied(const double (&squares)[lane_count]) {
        for (int n = 0; n < lane_count; ++n) {
            const int lane = (strictest_ + n) % lane_count;
            if (!exceeds(squares[lane], lane)) continue;
            strictest_ = lane;
            return false;
        }
        return true;
    }

    /// Honest: whether a cluster with these bounds is in the way of a lane that its sum of squares does not satisfy.
    bool is_in_the_way(const Lanes& bound, const double (&squares)[lane_count]) const {
        for (int i = 0; i < lane_count; ++i)
            if (safe_part * bound[i] * inverse_[i] > 1.0f && exceeds(squares[i], i)) return true;
        return false;
    }

    /// Honest: marks the lanes whose estimated error exceeds their tolerance; `largest` are their largest bounds.
    std::uint32_t broken(const double (&squares)[lane_count], const Lanes& largest) const {
        std::uint32_t lanes = 0;
        for (int i = 0; i < lane_count; ++i) lanes |= error(i, squares[i], largest[i]) > tolerance_[i] ? 1u << i : 0u;
        return lanes;
    }

    /// Honest: the luminance by which a lane may err, from its sum of squared bounds and its largest bound.
    float error(int lane, double squares, float largest) const {
        const auto summed = static_cast<float>(scale(lane) * std::sqrt(std::max(squares, 0.0)));
        return std::min(summed, error_scale_ * safe_part * largest);
    }

    /// Honest: below this priority a cluster's bounds are a safe part of what `lanes` points tolerate, in the mean.
    static float safe_priority(int lanes) { return static_cast<float>(lanes) / (safe_part * safe_part); }

    /// Honest: k of a lane. fit: docs/fits/honest-stop. It falls as the relative tolerance t = T over the light grows,
    /// since the bounds of coarse clusters are looser: coarse + (fine - coarse) / (1 + (t / t0)^2).
    float scale(int lane) const {
        float t = tolerance_[lane] > 0.0f ? loosest : 0.0f;
        if (light_[lane] > 0.0f) t = std::min(loosest, tolerance_[lane] / light_[lane]);
        return error_scale_ * (coarse_scale + (fine_scale - coarse_scale) * turn2 / (turn2 + t * t));
    }

  private:
    /// core::Tolerance::allows.
    RENDER2MPEG_ALWAYS_INLINED float allowed(int lane, float light) const {
        const float absolute = inlined::max(least_[lane], inlined::min(absolute_[lane], share_[lane] * light));
        return inlined::max(relative_[lane] * light, absolute);
    }

    /// Stands for no tolerance at all; any bound that matters is larger.
    static constexpr float least_tolerance = 1e-30f;
    bool exceeds(double squares, int lane) const {
        const double k = scale(lane), tolerance = tolerance_[lane];
        return k * k * squares > tolerance * tolerance;
    }

    /// Keeps squares of what is beyond any measure finite.
    static constexpr float largest_share = 1e15f;
    /// fit: docs/fits/honest-stop, "classic": 7.24 over its scenes, with one light per cluster.
    static constexpr float safe_part = 7.0f;
    static constexpr float fine_scale = 0.62f, coarse_scale = 0.36f, turn2 = 0.08f * 0.08f;
    static constexpr float loosest = 1e6f;

    Stop stop_ = Stop::honest;
    float error_scale_ = 1;
    int strictest_ = 0;
    alignas(64) Lanes absolute_{}, relative_{}, share_{}, least_{}, base_{}, light_{},
        tolerance_{}, inverse_{}, lowest_{};
};

}  // namespace render2mpeg::renderer
