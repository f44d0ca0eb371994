#include "renderer/cache/nearest_record.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/cache/glossy_record.h"

namespace render2mpeg::renderer {
namespace {

/// A record so near, in pixels, has the light of the point itself, if that changes up to there by no more than the
/// tolerance over `here_factor`. chosen: 0.1 of 0.1 to 0.3; 2 against none (docs/measurements.md#irradiance-cache).
constexpr float here_distance = 0.1f, here_factor = 2.0f;

/// Tolerances by which light may change up to a record that a point is moved to. chosen: 2 of none, 2, 4 and any
/// (docs/measurements.md#irradiance-cache).
constexpr float most_moved_change = 2.0f;

/// At least so many records show what light changes by, the own one included.
constexpr int least_nearby = 3;

/// Records nearer to each other than so many pixels differ by their gathering's errors. chosen: 0.25; not tuned.
constexpr float least_apart = 0.25f;

/// A record in the point's pixel or beside it, of its surface.
struct Nearby {
    const SurfaceMark* mark;
    SeenLobe lobe;
    glm::vec3 sent;  ///< into the pixel
};

class NearbyRecords {
  public:
    NearbyRecords(const CacheQuery& q, const RecordGrid& grid, const RecordStore& records) : q_(q), records_(records) {
        const SurfacePoint& p = q.point.point;
        const SurfaceMark here = mark_of(q);
        const int x = static_cast<int>(std::floor(q.at.x)), y = static_cast<int>(std::floor(q.at.y));
        // Its own pixel first, whose records are not to be crowded out.
        constexpr int pixels[9][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
        constexpr int border = RecordGrid::border;
        for (const auto& [right, down] : pixels) {
            const int column = x + right, row = y + down;
            if (std::min(column, row) < -border || column >= grid.width() + border || row >= grid.height() + border)
                continue;
            for (const SurfaceMark& m : grid.row(row, column, column)) {
                const float apart = q.extent * glm::length(m.at - q.at);
                if (m.surface == here.surface && on_one_surface(here, m, apart, q.extent, p.position_error)) add(m);
            }
        }
    }

    int count() const { return count_; }
    const Nearby& operator[](int i) const { return found_[static_cast<std::size_t>(i)]; }
    const IrradianceRecord& record(int i) const { return records_[(*this)[i].mark->record]; }

    /// Whether it lies in the pixel, where the point and it might be samples that share a gather point.
    bool is_own(int i) const {
        const SurfaceMark& m = *(*this)[i].mark;
        return glm::floor(m.at) == glm::floor(q_.at) &&
               glm::dot(m.shading_normal, q_.point.point.shading_normal) >= same_normal;
    }

    float distance(int i) const { return glm::length((*this)[i].mark->at - q_.at); }

    /// Noticeable change of light from the record to the point, if as on the steepest way to another; infinite where
    /// there are too few.
    float change(int i) const {
        const float way = distance(i);
        if (way == 0.0f) return 0.0f;
        if (count_ < least_nearby) return std::numeric_limits<float>::infinity();
        const Nearby& from = (*this)[i];
        float slope = 0;
        for (int k = 0; k < count_; ++k) {
            const float apart = std::max(glm::length((*this)[k].mark->at - from.mark->at), least_apart);
            slope = std::max(slope, core::noticed((*this)[k].sent - from.sent) / apart);
        }
        return slope * way;
    }

  private:
    void add(const SurfaceMark& m) {
        if (count_ == static_cast<int>(found_.size())) return;
        const IrradianceRecord& r = records_[m.record];
        const auto lobe = lobe_at(q_, r);
        if (!lobe) return;
        const PointLight light{r.direct, r.indirect, lobe->radiance};
        found_[static_cast<std::size_t>(count_++)] = {&m, *lobe, light.scattered(q_.point)};
    }

    const CacheQuery& q_;
    const RecordStore& records_;
    std::array<Nearby, 64> found_;  ///< the first `count_`
    int count_ = 0;
};

}  // namespace

void reuse_nearest(const CacheQuery& q, const RecordGrid& grid, RecordStore& records, const CacheErrorModel& model,
                   std::int64_t frame, CacheEstimate& result) {
    if (!grid.reaches(q.at, 1)) return;
    const NearbyRecords near(q, grid, records);
    float nearest = std::numeric_limits<float>::infinity(), noise = 0, cache_error = 0, change = 0;
    int own = -1;
    bool is_here = false;
    for (int i = 0; i < near.count(); ++i) {
        if (!near.is_own(i) || !(near.distance(i) < nearest)) continue;
        const IrradianceRecord& r = near.record(i);
        const float tolerance = q.tolerance.allows(core::luminance(near[i].sent));
        // The error of a capped cut would be no less if it were gathered again. That surfaces bend counts as if light
        // were told at the point.
        const float turned = model.noise * turn_error * glm::length(near[i].lobe.turned),
                    gathered = turned + model.noise * q.receives * r.error, changed = near.change(i),
                    disagreement = model.residual * here_factor * changed;
        if (!((r.capped ? turned : gathered) <= tolerance)) continue;
        const bool here = near.distance(i) <= here_distance && model.cache_error_scale * disagreement <= tolerance;
        if (!here && !(changed <= most_moved_change * tolerance)) continue;
        own = i;
        is_here = here;
        nearest = near.distance(i);
        noise = gathered;
        change = changed;
        cache_error = here ? core::divide_or(disagreement, tolerance, 0.0f) : 0.0f;
    }
    if (own < 0) return;
    const IrradianceRecord& r = near.record(own);
    PointLight& light = result.light;
    light = {r.direct, r.indirect, near[own].lobe.radiance};
    light.served = true;
    light.clamped = r.clamped * core::luminance(near[own].sent);
    light.capped = r.capped;
    light.age = static_cast<float>(frame - r.born);
    light.cache_error = cache_error;
    // Where the tolerance is finer in the next frame, neither may suffice.
    light.error =
        std::max(noise, is_here ? model.cache_error_scale * here_factor * change : change / most_moved_change);
    result.valid = true;
    const std::uint32_t index = near[own].mark->record;
    if (!is_here) result.moved_to = index;
    records.mark_used(index, frame);
}

}  // namespace render2mpeg::renderer
