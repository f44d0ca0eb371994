#include "renderer/record_own.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/record_lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Tolerances by which light may change up to a record that a point is moved to, on the steepest way from there to a
/// record near by. chosen: 2 of 1/2 (up to 0.1 pixels, as of the point itself), 2, 4 and any. By 2 % at quantiser 4 2,
/// 4 and any lose 0.03, 0.07, 0.19 dB of PSNR-Y in Sponza and 0.14, 0.22, 1.23 dB in Sibenik against light at the
/// pixels' middles, 0.004, -0.005, 0.03 and 0.003, -0.003, 0.26 dB against pixels of nine samples each
/// (docs/decisions/0018).
constexpr float most_change = 2.0f;

/// Records nearer to each other than so many pixels differ by their gathering's errors. chosen: 0.25; not tuned.
constexpr float least_apart = 0.25f;

/// A record in the point's pixel or beside it, of its surface.
struct Nearby {
    const RecordMark* mark;
    SeenLobe lobe;
    float luminance;  ///< that it sends into the pixel
};

class Nearest {
  public:
    Nearest(const RecordQuery& q, const RecordMap& map, const Records& records) : q_(q), records_(records) {
        const SurfacePoint& p = q.point.point;
        const RecordMark here{
            q.at, 0, surface_of(p.address, p.back_side), p.position, p.geometric_normal, p.shading_normal};
        const int x = static_cast<int>(std::floor(q.at.x)), y = static_cast<int>(std::floor(q.at.y));
        constexpr int border = RecordMap::border;
        for (int row = std::max(y - 1, -border); row <= std::min(y + 1, map.height() + border - 1); ++row)
            for (const RecordMark& m :
                 map.row(row, std::max(x - 1, -border), std::min(x + 1, map.width() + border - 1))) {
                const float apart = q.extent * glm::length(m.at - q.at);
                if (m.surface == here.surface && on_one_surface(here, m, apart, q.extent, p.position_error)) add(m);
            }
    }

    int count() const { return count_; }
    const Nearby& operator[](int i) const { return found_[static_cast<std::size_t>(i)]; }
    const Record& record(int i) const { return records_[(*this)[i].mark->record]; }

    /// Whether it lies in the pixel, where the point and it might be samples that share a gather point.
    bool is_own(int i) const {
        const RecordMark& m = *(*this)[i].mark;
        return glm::floor(m.at) == glm::floor(q_.at) &&
               glm::dot(m.shading_normal, q_.point.point.shading_normal) >= same_normal;
    }

    float distance(int i) const { return glm::length((*this)[i].mark->at - q_.at); }

    /// What luminance changes by from the record to the point, if as on the steepest way to another.
    float change(int i) const {
        const float way = distance(i);
        if (way == 0.0f) return 0.0f;
        if (count_ < 2) return std::numeric_limits<float>::infinity();
        const Nearby& from = (*this)[i];
        float slope = 0;
        for (int k = 0; k < count_; ++k) {
            const float apart = std::max(glm::length((*this)[k].mark->at - from.mark->at), least_apart);
            slope = std::max(slope, std::abs((*this)[k].luminance - from.luminance) / apart);
        }
        return slope * way;
    }

  private:
    void add(const RecordMark& m) {
        if (count_ == static_cast<int>(found_.size())) return;
        const Record& r = records_[m.record];
        const auto lobe = lobe_at(q_, r);
        if (!lobe) return;
        const PointLight light{r.direct, r.indirect, lobe->radiance};
        found_[static_cast<std::size_t>(count_++)] = {&m, *lobe, core::luminance(light.scattered(q_.point))};
    }

    const RecordQuery& q_;
    const Records& records_;
    std::array<Nearby, 64> found_;  ///< the first `count_`
    int count_ = 0;
};

}  // namespace

void take_own(const RecordQuery& q, const RecordMap& map, Records& records, const RecordTrust& trust,
              std::int64_t frame, RecordEstimate& result) {
    if (!map.reaches(q.at, 1)) return;
    const Nearest near(q, map, records);
    float nearest = std::numeric_limits<float>::infinity(), error = 0;
    int own = -1;
    for (int i = 0; i < near.count(); ++i) {
        if (!near.is_own(i) || near.distance(i) >= nearest) continue;
        const Record& r = near.record(i);
        const float tolerance = q.tolerance.allows(near[i].luminance);
        // What a cut that was capped is off by would be no less if it were gathered again.
        const float turned = trust.noise * turn_error * glm::length(near[i].lobe.turned),
                    noise = turned + trust.noise * q.receives * r.error;
        if ((r.capped ? turned : noise) > tolerance || near.change(i) > most_change * tolerance) continue;
        own = i;
        nearest = near.distance(i);
        error = noise;
    }
    if (own < 0) return;
    const Record& r = near.record(own);
    PointLight& light = result.light;
    light = {r.direct, r.indirect, near[own].lobe.radiance};
    light.served = true;
    light.clamped = r.clamped * near[own].luminance;
    light.capped = r.capped;
    light.age = static_cast<float>(frame - r.born);
    light.error = error;
    result.holds = true;
    const std::uint32_t index = near[own].mark->record;
    if (r.address != q.point.point.address) result.elsewhere = index;
    records.use(index, frame);
}

}  // namespace render2mpeg::renderer
