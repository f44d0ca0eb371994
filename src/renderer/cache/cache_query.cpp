#include "renderer/cache/cache_query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/cache/glossy_record.h"
#include "renderer/cache/nearest_record.h"
#include "renderer/cache/plane_fit.h"
#include "renderer/cut/gather_groups.h"

namespace render2mpeg::renderer {
namespace {

/// Pixels to each side that are looked at, in turn. The largest lets a lattice of 4 be interpolated.
constexpr int radii[] = {1, 2, 4, 6};
/// From this radius on planes are asked whether their records lie in two columns, so that a step may look like a slope
/// (PlaneFit::unsure_rise); within fewer pixels that is taken for granted.
constexpr int asked_for_columns = 4;

/// Records to one side of a pixel, or along a line, as at rims of surfaces and on thin mouldings, carry no plane.
/// So many of them serve by their mean if one is so near, in pixels, and if they disagree by so much less than the
/// tolerance, and by less in proportion where the pixel lies farther from their middle than they do: as if light
/// changed on as it does among them. chosen: 4 of 4 and 6 records, 3 of 1 to 3 times, 0.75 of 0.75 and 1.5 pixels
/// (docs/measurements.md#irradiance-cache). Records that all lie in one place say nothing of another, however well they
/// agree: no farther than four times what they are apart by (chosen without trial: seldom met).
constexpr int least_for_mean = 4;
constexpr float mean_factor = 3.0f, mean_distance = 0.75f, most_reach = 4.0f;

/// Standard errors that the error of a record is; and the part of the mean square of what records are off a plane that
/// counts as chance. chosen: 0.12 of 0 to 4: to discount all of it hides real steps.
constexpr float errors_told = 1.3f, chance_factor = 0.12f;

/// The factor q of a residual. What neighbours disagree by counts for more where the tolerance is fine, since light has
/// many small edges and few large ones. chosen: about 2 at 2 % of 1.6 and 2; it falls by half at 10 % of 6 to 15 %
/// (docs/measurements.md#irradiance-cache).
float residual_factor(const PointTolerance& t, float light, float tolerance) {
    constexpr float coarse = 0.62f, fine = 2.1f, turn2 = 0.1f * 0.1f;
    const float relative = core::divide_or(tolerance, t.base + std::max(light, 0.0f), 1.0f);
    return coarse + (fine - coarse) * turn2 / (turn2 + relative * relative);
}

/// A record that takes part.
struct Neighbour {
    const IrradianceRecord* record;
    std::uint32_t index;
    SeenLobe lobe;
};

/// One that lies on the point's surface.
struct Candidate {
    const SurfaceMark* mark;
    glm::vec2 offset;  ///< from the point, pixels
    float distance2;
};

class Neighbours {
  public:
    /// Those within `radius` of the query on its surface; false where there are too many or too few.
    bool find(const CacheQuery& q, const RecordGrid& grid, const RecordStore& records, int radius);
    /// Whether more lie within the radius than a plane takes.
    bool is_full() const { return is_full_; }
    /// Fits a plane through them, else their mean. By how much their residual counts for more than in a plane (1); 0:
    /// neither fits.
    float fit();
    PlaneFit& plane() { return plane_; }
    float weight(int i) const { return plane_.weight(i); }
    /// Possible error of gathering, given the point's response to irradiance.
    float noise(float receives, bool independent) const;
    /// Mean square of the error that chance puts on its records, in luminance of the pixel.
    float chance(float receives) const;
    int count() const { return plane_.count(); }
    const Neighbour& operator[](int i) const { return found_[static_cast<std::size_t>(i)]; }

  private:
    bool find_candidates(const CacheQuery& q, const RecordGrid& grid, int radius);

    /// Those whose lobes say nothing of the point's leave room for others.
    static constexpr int most_candidates = 4 * PlaneFit::most;
    std::array<Candidate, most_candidates> candidates_;
    int candidate_count_ = 0;
    bool is_full_ = false;
    std::array<Neighbour, PlaneFit::most> found_;
    PlaneFit plane_;
};

/// Those of the query's surface; false where there are too many, or too few.
bool Neighbours::find_candidates(const CacheQuery& q, const RecordGrid& grid, int radius) {
    candidate_count_ = 0;
    is_full_ = false;
    if (!grid.reaches(q.at, radius)) return false;
    const auto reach = static_cast<float>(radius) + 0.5f;
    const int x = static_cast<int>(std::floor(q.at.x)), y = static_cast<int>(std::floor(q.at.y));
    const SurfacePoint& p = q.point.point;
    const SurfaceMark here = mark_of(q);
    float nearest2 = std::numeric_limits<float>::max();
    for (int row = std::max(y - radius, -RecordGrid::border);
         row <= std::min(y + radius, grid.height() + RecordGrid::border - 1); ++row) {
        for (const SurfaceMark& m : grid.row(row, std::max(x - radius, -RecordGrid::border),
                                             std::min(x + radius, grid.width() + RecordGrid::border - 1))) {
            const glm::vec2 offset = m.at - q.at;
            const float distance2 = glm::dot(offset, offset);
            if (distance2 > reach * reach || m.surface != here.surface ||
                !on_one_surface(here, m, q.extent * std::sqrt(distance2), q.extent, p.position_error))
                continue;
            if (candidate_count_ == most_candidates) {
                is_full_ = true;
                return false;
            }
            candidates_[static_cast<std::size_t>(candidate_count_++)] = {&m, offset, distance2};
            nearest2 = std::min(nearest2, distance2);
        }
    }
    return candidate_count_ >= PlaneFit::least ||
           (candidate_count_ >= least_for_mean && nearest2 <= mean_distance * mean_distance);
}

bool Neighbours::find(const CacheQuery& q, const RecordGrid& grid, const RecordStore& records, int radius) {
    plane_.clear();
    if (!find_candidates(q, grid, radius)) return false;
    const auto reach = static_cast<float>(radius) + 0.5f;
    const SurfacePoint& p = q.point.point;
    const glm::vec3 reflects = q.point.weight * p.bsdf.diffuse;
    for (int i = 0; i < candidate_count_; ++i) {
        const Candidate& c = candidates_[static_cast<std::size_t>(i)];
        const IrradianceRecord& r = records[c.mark->record];
        const auto lobe = lobe_at(q, r);
        if (!lobe) continue;
        if (plane_.is_full()) {
            is_full_ = true;
            return false;
        }
        const float falloff = 1.0f - c.distance2 / (reach * reach * 1.1f);
        found_[static_cast<std::size_t>(plane_.count())] = {&r, c.mark->record, *lobe};
        plane_.add(c.offset, falloff * falloff / (0.25f + c.distance2),
                   reflects * (r.direct + r.indirect) + q.point.weight * lobe->radiance);
    }
    return plane_.count() > 0;
}

float Neighbours::fit() {
    if (plane_.fit()) return 1.0f;
    if (count() < least_for_mean || plane_.distance(plane_.nearest()) > mean_distance) return 0.0f;
    if (!plane_.fit_mean()) return 0.0f;
    const float reach = plane_.reach();
    return reach < most_reach ? mean_factor * std::max(1.0f, reach) : 0.0f;
}

float Neighbours::chance(float receives) const {
    float sum = 0, square = 0;
    for (int i = 0; i < count(); ++i) {
        const float error = receives * (*this)[i].record->error / errors_told;
        sum += std::sqrt(plane_.closeness(i)) * error * error;
        square += std::sqrt(plane_.closeness(i));
    }
    return core::divide_or(sum, square, 0.0f);
}

float Neighbours::noise(float receives, bool independent) const {
    // Records of one set err alike, since the same lights stand for their clusters; those of different sets do not.
    std::array<float, representative_sets> of_set{};
    float square = 0;
    glm::vec3 turned(0);
    for (int i = 0; i < count(); ++i) {
        const Neighbour& n = (*this)[i];
        turned += weight(i) * n.lobe.turned;
        const float error = std::abs(weight(i)) * n.record->error;
        if (independent)
            square += error * error;
        else
            of_set[n.record->set % of_set.size()] += error;
    }
    for (const float sum : of_set) square += sum * sum;
    return receives * std::sqrt(square) + turn_error * glm::length(turned);
}

/// Possible error of interpolation: luminance of the pixel.
struct ErrorEstimate {
    float tolerance = 0;
    float unscaled = std::numeric_limits<float>::infinity();       ///< of interpolation, at an error scale of 1
    float interpolation = std::numeric_limits<float>::infinity();  ///< the same at the model's scale
    float noise = 0;                                               ///< of the records themselves

    bool is_allowed() const { return interpolation <= tolerance && noise <= tolerance; }
};

/// Tests 2 to 4 of docs/model/irradiance-cache.md, "Interpolation"; not allowed where nothing fits.
ErrorEstimate estimate_error(Neighbours& near, const CacheQuery& q, const CacheErrorModel& model, int radius) {
    ErrorEstimate error;
    const float reach = near.fit();
    if (!(reach > 0.0f)) return error;
    const PlaneFit& plane = near.plane();
    const float light = core::luminance(plane.value());
    error.tolerance = q.tolerance.allows(light);
    // Residual of the records about the plane,
    const float factor = residual_factor(q.tolerance, light, error.tolerance);
    float off = plane.residual();
    if (model.independent) off = core::sqrt_or_zero(off * off - chance_factor * near.chance(q.receives));
    const float residual = model.residual * factor * (reach > 1.0f ? reach * factor : 1.0f) * off;
    // a step that may look like a slope,
    float rise = model.step * plane.rise();
    if (radius >= asked_for_columns && rise > residual) rise = model.step * plane.unsure_rise();
    error.unscaled = std::max(residual, rise);
    error.interpolation = model.cache_error_scale * error.unscaled;
    // and the records' own errors.
    error.noise = model.noise * near.noise(q.receives, model.independent);
    return error;
}

PointLight blend(const Neighbours& n, const GatherPoint& p, std::int64_t frame) {
    PointLight light;
    float clamped = 0, age = 0, sum = 0;
    glm::vec3 low[3]{glm::vec3(1e30f), glm::vec3(1e30f), glm::vec3(1e30f)}, high[3]{};
    for (int i = 0; i < n.count(); ++i) {
        const IrradianceRecord& r = *n[i].record;
        light.direct += n.weight(i) * r.direct;
        light.indirect += n.weight(i) * r.indirect;
        light.glossy += n.weight(i) * n[i].lobe.radiance;
        light.capped = light.capped || r.capped;
        clamped += n.weight(i) * r.clamped;
        age += std::abs(n.weight(i)) * static_cast<float>(frame - r.born);
        sum += std::abs(n.weight(i));
        low[0] = glm::min(low[0], r.direct);
        high[0] = glm::max(high[0], r.direct);
        low[1] = glm::min(low[1], r.indirect);
        high[1] = glm::max(high[1], r.indirect);
        low[2] = glm::min(low[2], n[i].lobe.radiance);
        high[2] = glm::max(high[2], n[i].lobe.radiance);
    }
    light.direct = glm::clamp(light.direct, low[0], high[0]);
    light.indirect = glm::clamp(light.indirect, low[1], high[1]);
    light.glossy = glm::clamp(light.glossy, low[2], high[2]);
    light.clamped = std::max(clamped, 0.0f) * core::luminance(light.scattered(p));
    light.age = core::divide_or(age, sum, 0.0f);
    return light;
}

}  // namespace

CacheEstimate query_cache(const CacheQuery& q, const RecordGrid& grid, RecordStore& records,
                          const CacheErrorModel& model, std::int64_t frame) {
    CacheEstimate result;
    // Interpolate among the nearest records that agree within the point's tolerance,
    Neighbours near;
    for (const int radius : radii) {
        result.radius = radius;
        if (near.find(q, grid, records, radius)) {
            const ErrorEstimate error = estimate_error(near, q, model, radius);
            if (!error.is_allowed()) continue;
            result.valid = true;
            result.light = blend(near, q.point, frame);
            result.light.served = true;
            result.light.cache_error = core::divide_or(error.unscaled, error.tolerance, 0.0f);
            result.light.error = std::max(error.interpolation, error.noise);
            for (int i = 0; i < near.count(); ++i) records.mark_used(near[i].index, frame);
            return result;
        }
        // Too many records for this radius are too many for the next.
        if (near.is_full()) break;
    }
    // else reuse the nearest record in the point's own pixel.
    reuse_nearest(q, grid, records, model, frame, result);
    return result;
}

}  // namespace render2mpeg::renderer
