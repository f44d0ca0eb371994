#include "renderer/cache/local_regression.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/cache/receiver.h"
#include "renderer/gather/ray_sums.h"

namespace render2mpeg::renderer {
namespace {

/// Pixels to each side that records are taken from, in turn. chosen: up to 6 of 6 and 8; the larger errs no less.
/// `common`: variance of the mean of 8x8 pixels over that of one, as if planes of all had this radius and records lay
/// evenly (docs/model/irradiance-cache.md#blocks-have-a-price).
struct Radius {
    int pixels = 0;
    double common = 0;
};
constexpr Radius radii[] = {{1, 0.0187}, {2, 0.0568}, {4, 0.1540}, {6, 0.2864}};
constexpr int largest_radius = 6;

/// The same of pixels that have a record each.
constexpr double common_alone = 1.0 / 64;

/// Weights fall to zero at so many times the square of the reach. chosen: 1.1, so that the farthest count a little; not
/// tuned.
constexpr double falloff_end = 1.1;

/// A bent plane takes four records; the others tell what it misses. Through the six of two columns of a lattice it
/// always passes, and a step between them looks like a slope: seven are more than these. chosen: the least such number.
constexpr int unknowns = 4, least_records = 7;

/// Sum of the sizes of a plane's weights: 1.5 within the records. chosen: 2, so that rims of the picture are served.
constexpr double most_stretch = 2;

/// Share of s^3 below which records lie along a line. chosen: 1e-5 of 1e-3 to 1e-6, at which thin columns still
/// carry planes: an even disc has 0.02.
constexpr double line_share = 1e-5;

/// Likewise the share of it below which they lie along a circle, and tell a bend from a height as badly. Not tuned.
constexpr double circle_share = 1e-3;

/// Records in the place of a point lie so near, in pixels. chosen: 0.1, where light is another in corners alone.
constexpr float same_place = 0.1f;

}  // namespace

void LocalRegression::collect(const CacheQuery& q, Of of, const RecordGrid& grid, const RecordStore& records,
                              std::uint32_t own) {
    members_.clear();
    if (!grid.reaches(q.at, largest_radius)) return;
    constexpr float reach = static_cast<float>(largest_radius) + 0.5f;
    const int x = static_cast<int>(std::floor(q.at.x)), y = static_cast<int>(std::floor(q.at.y)),
              left = std::max(x - largest_radius, -RecordGrid::border),
              right = std::min(x + largest_radius, grid.width() + RecordGrid::border - 1),
              top = std::max(y - largest_radius, -RecordGrid::border),
              bottom = std::min(y + largest_radius, grid.height() + RecordGrid::border - 1);
    const SurfacePoint& p = q.point.point;
    const SurfaceMark here = mark_of(q);
    const GatherPoint plain = plain_receiver(q.point);
    const float shown = of == Of::all_light ? q.receives : receives(plain), receives2 = shown * shown;
    const glm::vec3 reflects = q.point.weight * p.bsdf.diffuse;
    for (int row = top; row <= bottom; ++row) {
        for (const SurfaceMark& m : grid.row(row, left, right)) {
            const glm::vec2 offset = m.at - q.at;
            const float distance2 = glm::dot(offset, offset);
            if (distance2 > reach * reach || m.surface != here.surface ||
                !on_one_surface(here, m, q.extent * std::sqrt(distance2), q.extent, p.position_error))
                continue;
            const IrradianceRecord& r = records[m.record];
            if (of == Of::change && !r.looks_now) continue;
            const auto lobe = lobe_at(q, r);
            if (!lobe) continue;
            const auto rays = static_cast<float>(r.ray_count);
            members_.push_back(
                {m.record, offset, distance2,
                 of == Of::all_light ? core::luminance(reflects * r.irradiance() + q.point.weight * lobe->radiance)
                                     : static_cast<float>(shown_luminance(plain, r.by_rays)),
                 rays > 0 ? std::sqrt(rays) : 1.0f, rays > 0 ? std::pow(batch_rays / rays, variance_power) : 0.0f,
                 receives2 * r.batch_variance, own == none ? distance2 < same_place * same_place : m.record == own,
                 *lobe});
        }
    }
    if (of == Of::change) explain_change(plain, records, receives2);
}

/// Makes the members' values those of a change: what looks find beyond a factor of the anchors' looks, by least
/// squares over all members.
void LocalRegression::explain_change(const GatherPoint& plain, const RecordStore& records, float receives2) {
    const auto closeness = [](const Member& m) {
        const double c = 1.0 - m.distance2 / (falloff_end * (largest_radius + 0.5) * (largest_radius + 0.5));
        return c * c;
    };
    double both = 0, before = 0, variance = 0, sum = 0, spread = 0;
    for (const Member& m : members_) {
        const IrradianceRecord& r = records[m.record];
        const double now = shown_luminance(plain, r.look.light), then = shown_luminance(plain, r.anchor->look.light),
                     w = closeness(m);
        both += w * now * then;
        before += w * then * then;
        variance += w * 0.5 * r.look.difference * r.look.difference;
        sum += w;
    }
    // Of few looks it would explain their noise.
    factor_ = members_.size() < std::size_t{least_records} ? 1.0 : core::divide_or(both, before, 1.0);
    batch_variance_now_ = receives2 * static_cast<float>(core::divide_or(variance, sum, 0.0));
    for (Member& m : members_) {
        const IrradianceRecord& r = records[m.record];
        m.value = static_cast<float>(shown_luminance(plain, r.look.light) -
                                     factor_ * shown_luminance(plain, r.anchor->look.light));
        const double difference = r.look.difference - factor_ * r.anchor->look.difference;
        spread += closeness(m) * 0.5 * difference * difference;
        m.precision = 1;
        m.batch_share = std::pow(1.0f * batch_rays / first_rays, variance_power);
    }
    // One difference alone tells little of a variance.
    for (Member& m : members_) m.batch_variance = receives2 * static_cast<float>(core::divide_or(spread, sum, 0.0));
}

/// Considers the bent plane through records within a radius.
void LocalRegression::fit_plane(int radius, double common, RegressionError& best) {
    const float reach = static_cast<float>(radius) + 0.5f, reach2 = reach * reach;
    const auto closeness = [&](const Member& m) { return 1.0 - m.distance2 / (falloff_end * reach2); };
    // Normal equations of a bent plane about the point.
    const auto basis = [&](const Member& m) {
        return glm::dvec4(1.0, m.offset.x / reach, m.offset.y / reach, m.distance2 / reach2);
    };
    glm::dmat4 moments(0.0);
    double batch = 0, close = 0;
    int count = 0;
    for (const Member& m : members_) {
        if (m.distance2 > reach2) continue;
        const double k = closeness(m) * closeness(m);
        const glm::dvec4 b = basis(m);
        moments += glm::outerProduct(k * m.precision * b, b);
        batch += k * m.batch_variance;
        close += k;
        ++count;
    }
    if (count < least_records) return;
    const double s = moments[0][0], flat = glm::determinant(glm::dmat3(moments));
    // Records along a line carry no plane; the determinant of those all around is some s^3 / 50.
    if (!(flat > line_share * s * s * s) || !(glm::determinant(moments) > circle_share * s * flat)) return;
    const glm::dmat4 inverse = glm::inverse(moments);
    batch /= close;
    plane_.assign(members_.size(), 0.0f);
    glm::dvec4 plane(0);
    double variance = 0, stretch = 0;
    for (std::size_t i = 0; i < members_.size(); ++i) {
        const Member& m = members_[i];
        if (m.distance2 > reach2) continue;
        const glm::dvec4 row = inverse * basis(m) * (closeness(m) * closeness(m) * m.precision);
        plane_[i] = static_cast<float>(row.x);
        stretch += std::abs(row.x);
        variance += row.x * row.x * batch * m.batch_share;
        plane += row * static_cast<double>(m.value);
    }
    // What records are off it by, beyond their variance.
    double off = 0, chance = 0, sum = 0;
    for (const Member& m : members_) {
        if (m.distance2 > reach2) continue;
        const double d = m.value - glm::dot(plane, basis(m)), w = closeness(m);
        off += w * d * d;
        chance += w * m.batch_share;
        sum += w;
    }
    off *= count / ((count - 1.0 * unknowns) * sum);
    chance *= batch / sum;
    const double square = variance + std::max(off - chance, 0.0);
    if (!(stretch <= most_stretch) || !std::isfinite(square) || (best.is_valid() && !(square < best.square))) return;
    best = {square, variance, common * variance, batch, core::divide_or(variance, chance, 1.0), radius};
    weights_.swap(plane_);
}

/// Considers a record in the point's place.
void LocalRegression::take_own(RegressionError& best) {
    // Neighbours know better how rays vary than its own do: the few of a rim that missed what is bright look sure.
    double all = 0;
    for (const Member& m : members_) all += m.batch_variance;
    const double batch =
        best.is_valid() ? best.batch_variance : core::divide_or(all, static_cast<double>(members_.size()), 0.0);
    for (std::size_t i = 0; i < members_.size(); ++i) {
        const Member& m = members_[i];
        if (!m.is_own) continue;
        const double square = batch * m.batch_share;
        if (!std::isfinite(square) || (best.is_valid() && !(square < best.square))) continue;
        best = {square, square, common_alone * square, batch, 1.0, 0};
        weights_.assign(members_.size(), 0.0f);
        weights_[i] = 1;
    }
}

RegressionError LocalRegression::estimate() {
    RegressionError best;
    for (const Radius& radius : radii) fit_plane(radius.pixels, radius.common, best);
    take_own(best);
    return best;
}

}  // namespace render2mpeg::renderer
