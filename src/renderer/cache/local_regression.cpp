#include "renderer/cache/local_regression.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/isa_clones.h"
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

/// Crowds look no further: light changes from leaf to leaf more than from pixel to pixel, and records are many.
constexpr int largest_of_crowd = 2;

/// Records of a crowd face alike if the cosine between their normals is no less. Not tuned.
constexpr float same_facing = 0.7f;

/// Whether records of the crowd about a point may tell its light, whatever object they are of.
bool is_of_crowd(const SurfaceMark& here, const SurfaceMark& m) {
    return m.surface >> 33 == here.surface >> 33 && glm::dot(m.shading_normal, here.shading_normal) >= same_facing;
}

/// The same of pixels that have a record each.
constexpr double common_alone = 1.0 / 64;

/// Square of the distance of lanes without a member, pixels: beyond all radii.
constexpr float far_away = 64;

/// Weights fall to zero at so many times the square of the reach. chosen: 1.1, so that the farthest count a little; not
/// tuned.
constexpr float falloff_end = 1.1f;

/// A bent plane takes four records; the others tell what it misses. Through the six of two columns of a lattice it
/// always passes, and a step between them looks like a slope: seven are more than these. chosen: the least such number.
constexpr int unknowns_of_plane = 4, least_records = 7;

/// Fewer than that have a mean, of four at least, whose middle is within a pixel of the point. chosen: 4 of 2, 3, 4: a
/// crowd of people takes 0.87 of the rays for 1.05 times the squared error; by fewer records errors grow faster.
constexpr int unknowns_of_mean = 1, least_of_mean = 4;
constexpr double middle_of_mean = 1;

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
    lanes_.clear();
    if (!grid.reaches(q.at, largest_radius)) return;
    crowded_ = q.crowded;
    priced_ = q.priced;
    alike_ = crowded_ ? std::max(static_cast<double>(q.tolerance.noise), 1.0) : 1.0;
    const int radius = crowded_ ? largest_of_crowd : largest_radius;
    const float reach = static_cast<float>(radius) + 0.5f;
    const int x = static_cast<int>(std::floor(q.at.x)), y = static_cast<int>(std::floor(q.at.y)),
              top = std::max(y - radius, -RecordGrid::border),
              bottom = std::min(y + radius, grid.height() + RecordGrid::border - 1);
    const SurfacePoint& p = q.point.point;
    const SurfaceMark here = mark_of(q);
    const GatherPoint plain = plain_receiver(q.point);
    const float shown = of == Of::all_light ? q.receives : receives(plain), receives2 = shown * shown;
    const glm::vec3 reflects = q.point.weight * p.bsdf.diffuse;
    const auto take = [&](const SurfaceMark& m, float aside) {
        const glm::vec2 offset = m.at + glm::vec2(aside, 0.0f) - q.at;
        const float distance2 = glm::dot(offset, offset);
        if (distance2 > reach * reach) return;
        const bool same = m.surface == here.surface &&
                          on_one_surface(here, m, q.extent * std::sqrt(distance2), q.extent, p.position_error);
        if (!same && !(crowded_ && is_of_crowd(here, m))) return;
        const IrradianceRecord& r = records[m.record];
        if (of == Of::change && !r.is_pilot_now) return;
        const auto lobe = lobe_at(q, r);
        if (!lobe) return;
        const std::size_t i = members_.size(), k = i % member_lanes;
        if (k == 0) lanes_.emplace_back().distance2.fill(far_away);
        MemberLanes& lanes = lanes_.back();
        lanes.x[k] = offset.x;
        lanes.y[k] = offset.y;
        lanes.distance2[k] = distance2;
        lanes.value[k] = of == Of::all_light
                             ? core::luminance(reflects * r.irradiance() + q.point.weight * lobe->radiance)
                             : static_cast<float>(shown_luminance(plain, r.by_rays));
        lanes.precision[k] = r.ray_count > 0 ? std::sqrt(static_cast<float>(r.ray_count)) : 1.0f;
        lanes.batch_share[k] = static_cast<float>(batch_share(r.ray_count));
        lanes.batch_variance[k] = receives2 * r.batch_variance;
        Member& member = members_.emplace_back();
        member.record = m.record;
        member.is_own = own == none ? same && distance2 < same_place * same_place : m.record == own;
        member.lobe = *lobe;
    };
    for (int row = top; row <= bottom; ++row) grid.visit_row(row, x - radius, x + radius, take);
    if (of == Of::change) explain_change(plain, records, receives2);
}

/// Makes the members' values those of a change, m - c m0: what pilots find beyond a factor c of the baselines', by
/// least squares over all members.
void LocalRegression::explain_change(const GatherPoint& plain, const RecordStore& records, float receives2) {
    const auto closeness = [&](std::size_t i) {
        const double c = 1.0 - lanes_of(i).distance2[i % member_lanes] /
                                   (1.0 * falloff_end * (largest_radius + 0.5) * (largest_radius + 0.5));
        return c * c;
    };
    double both = 0, before = 0, variance = 0, sum = 0, spread = 0;
    for (std::size_t i = 0; i < members_.size(); ++i) {
        const IrradianceRecord& r = records[members_[i].record];
        const double now = shown_luminance(plain, r.pilot.light),
                     then = shown_luminance(plain, r.baseline->pilot.light), w = closeness(i);
        both += w * now * then;
        before += w * then * then;
        variance += w * 0.5 * r.pilot.difference * r.pilot.difference;
        sum += w;
    }
    // Of few pilots it would explain their noise.
    factor_ = members_.size() < std::size_t{least_records} ? 1.0 : core::divide_or(both, before, 1.0);
    batch_variance_now_ = receives2 * static_cast<float>(core::divide_or(variance, sum, 0.0));
    for (std::size_t i = 0; i < members_.size(); ++i) {
        const IrradianceRecord& r = records[members_[i].record];
        MemberLanes& lanes = lanes_of(i);
        const std::size_t k = i % member_lanes;
        lanes.value[k] = static_cast<float>(shown_luminance(plain, r.pilot.light) -
                                            factor_ * shown_luminance(plain, r.baseline->pilot.light));
        const double difference = r.pilot.difference - factor_ * r.baseline->pilot.difference;
        spread += closeness(i) * 0.5 * difference * difference;
        lanes.precision[k] = 1;
        lanes.batch_share[k] = static_cast<float>(batch_share(pilot_rays));
    }
    // One difference alone tells little of a variance.
    const float batch = receives2 * static_cast<float>(core::divide_or(spread, sum, 0.0));
    for (std::size_t i = 0; i < members_.size(); ++i) lanes_of(i).batch_variance[i % member_lanes] = batch;
}

/// A bent plane about a point, through members within a reach.
struct LocalRegression::Plane {
    float reach = 0;
    glm::vec4 row{0};    ///< of the inverse of the normal equations: gives weights
    glm::vec4 value{0};  ///< of 1, x, y, x^2 + y^2, over the reach

    /// Sums that the normal equations are made of: moments of 1, x, y, x^2 + y^2, then of these times the value.
    enum Moment { m1, mx, my, mz, mxx, mxy, mxz, myy, myz, mzz, v1, vx, vy, vz, batch, close, number, moments };
    /// Sums over members once it is found.
    enum Fit { stretch, variance, off, chance, closeness, fits };
    template <int count>
    using Sums = std::array<MemberValues, count>;

    void sum(std::span<const MemberLanes> members, Sums<moments>& sums) const;
    std::optional<glm::dmat4> inverse_of(const std::array<double, moments>& totals) const;
    /// Weights of members as well.
    void fit(std::span<const MemberLanes> members, float* weights, Sums<fits>& sums) const;
};

RENDER2MPEG_CLONES
void LocalRegression::Plane::sum(std::span<const MemberLanes> members, Sums<moments>& sums) const {
    const float per_reach = 1.0f / reach, per_square = per_reach * per_reach, reach2 = reach * reach;
    Sums<moments> s{};
    for (const MemberLanes& m : members) {
        for (std::size_t i = 0; i < member_lanes; ++i) {
            const float z = m.distance2[i] * per_square, x = m.x[i] * per_reach, y = m.y[i] * per_reach,
                        c = 1.0f - z * (1.0f / falloff_end), near = m.distance2[i] <= reach2 ? c * c : 0.0f,
                        w = near * m.precision[i], wx = w * x, wy = w * y, wz = w * z, v = m.value[i];
            s[m1][i] += w;
            s[mx][i] += wx;
            s[my][i] += wy;
            s[mz][i] += wz;
            s[mxx][i] += wx * x;
            s[mxy][i] += wx * y;
            s[mxz][i] += wx * z;
            s[myy][i] += wy * y;
            s[myz][i] += wy * z;
            s[mzz][i] += wz * z;
            s[v1][i] += w * v;
            s[vx][i] += wx * v;
            s[vy][i] += wy * v;
            s[vz][i] += wz * v;
            s[batch][i] += near * m.batch_variance[i];
            s[close][i] += near;
            s[number][i] += m.distance2[i] <= reach2 ? 1.0f : 0.0f;
        }
    }
    sums = s;
}

RENDER2MPEG_CLONES
void LocalRegression::Plane::fit(std::span<const MemberLanes> members, float* weights, Sums<fits>& sums) const {
    const float per_reach = 1.0f / reach, per_square = per_reach * per_reach, reach2 = reach * reach;
    Sums<fits> s{};
    for (const MemberLanes& m : members) {
        for (std::size_t i = 0; i < member_lanes; ++i) {
            const float z = m.distance2[i] * per_square, x = m.x[i] * per_reach, y = m.y[i] * per_reach,
                        c = m.distance2[i] <= reach2 ? 1.0f - z * (1.0f / falloff_end) : 0.0f,
                        w = c * c * m.precision[i] * (row.x + row.y * x + row.z * y + row.w * z),
                        d = m.value[i] - (value.x + value.y * x + value.z * y + value.w * z);
            weights[i] = w;
            s[stretch][i] += inlined::abs(w);
            s[variance][i] += w * w * m.batch_share[i];
            s[off][i] += c * d * d;
            s[chance][i] += c * m.batch_share[i];
            s[closeness][i] += c;
        }
        weights += member_lanes;
    }
    sums = s;
}

namespace {

/// Sum of each number's lanes.
template <std::size_t count, std::size_t width>
std::array<double, count> totals(const std::array<std::array<float, width>, count>& sums) {
    std::array<double, count> out{};
    for (std::size_t k = 0; k < count; ++k)
        for (const float lane : sums[k]) out[k] += static_cast<double>(lane);
    return out;
}

}  // namespace

/// Inverse of the normal equations of records' bent plane, or of their mean; none where they carry neither.
std::optional<glm::dmat4> LocalRegression::Plane::inverse_of(const std::array<double, moments>& m) const {
    const double s = m[m1];
    if (m[number] < 1.0 * least_records) {
        const bool is_about_point = std::hypot(m[mx], m[my]) * static_cast<double>(reach) <= middle_of_mean * s;
        if (m[number] < 1.0 * least_of_mean || !is_about_point) return std::nullopt;
        glm::dmat4 of_mean(0);
        of_mean[0][0] = 1 / s;
        return of_mean;
    }
    const glm::dmat4 equations(m[m1], m[mx], m[my], m[mz], m[mx], m[mxx], m[mxy], m[mxz], m[my], m[mxy], m[myy], m[myz],
                               m[mz], m[mxz], m[myz], m[mzz]);
    const double flat = glm::determinant(glm::dmat3(equations));
    // Records along a line carry no plane; the determinant of those all around is some s^3 / 50.
    if (!(flat > line_share * s * s * s) || !(glm::determinant(equations) > circle_share * s * flat))
        return std::nullopt;
    return glm::inverse(equations);
}

/// Considers the bent plane through records within a radius, or the mean of few.
void LocalRegression::fit_plane(int radius, double common, RegressionError& best) {
    using P = Plane;
    P plane{static_cast<float>(radius) + 0.5f};
    P::Sums<P::moments> lanes;
    plane.sum(lanes_, lanes);
    const std::array<double, P::moments> m = totals(lanes);
    // The few records of a mean tell too little of their error for a bound.
    const double count = m[P::number];
    if (!priced_ && count < 1.0 * least_records) return;
    const std::optional<glm::dmat4> inverse = plane.inverse_of(m);
    if (!inverse) return;
    const double batch = m[P::batch] / m[P::close],
                 unknowns = count < 1.0 * least_records ? unknowns_of_mean : unknowns_of_plane;
    plane.row = glm::vec4((*inverse)[0]);
    plane.value = glm::vec4(*inverse * glm::dvec4(m[P::v1], m[P::vx], m[P::vy], m[P::vz]));
    plane_.resize(lanes_.size() * member_lanes);
    P::Sums<P::fits> fit_lanes;
    plane.fit(lanes_, plane_.data(), fit_lanes);
    const std::array<double, P::fits> f = totals(fit_lanes);
    const double variance = alike_ * batch * f[P::variance], chance = batch * f[P::chance] / f[P::closeness],
                 // What records are off it by, beyond their variance.
        off = f[P::off] * count / ((count - unknowns) * f[P::closeness]),
                 square = variance + std::max(off - chance, 0.0);
    if (!(f[P::stretch] <= most_stretch) || !std::isfinite(square) || (best.is_valid() && !(square < best.square)))
        return;
    best = {square, variance, common * variance, batch, core::divide_or(variance / alike_, chance, 1.0), radius};
    weights_.swap(plane_);
}

/// Considers a record in the point's place.
void LocalRegression::take_own(RegressionError& best) {
    // Neighbours know better how rays vary than its own do: the few of a rim that missed what is bright look sure.
    double all = 0;
    for (const MemberLanes& lanes : lanes_)
        for (const float of_member : lanes.batch_variance) all += static_cast<double>(of_member);
    const double batch =
        best.is_valid() ? best.batch_variance : core::divide_or(all, static_cast<double>(members_.size()), 0.0);
    for (std::size_t i = 0; i < members_.size(); ++i) {
        if (!members_[i].is_own) continue;
        const double square = batch * lanes_of(i).batch_share[i % member_lanes];
        if (!std::isfinite(square) || (best.is_valid() && !(square < best.square))) continue;
        best = {square, square, common_alone * square, batch, 1.0, 0};
        weights_.assign(members_.size(), 0.0f);
        weights_[i] = 1;
    }
}

RegressionError LocalRegression::estimate() {
    RegressionError best;
    for (const Radius& radius : radii)
        if (!crowded_ || radius.pixels <= largest_of_crowd) fit_plane(radius.pixels, radius.common, best);
    take_own(best);
    return best;
}

}  // namespace render2mpeg::renderer
