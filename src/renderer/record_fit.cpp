#include "renderer/record_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Records that one estimate may rest on. Where there are more within a radius and the nearer ones disagreed, more will
/// not help.
constexpr int most_records = 40;
/// Pixels to each side that are looked at, in turn. The largest lets a lattice of 4 be interpolated.
constexpr int radii[] = {1, 2, 4, 6};
/// With fewer than this, records may lie in two columns, through which a plane always passes: a step between them is no
/// slope.
constexpr int tells_steps = 4;

/// A plane takes three; the rest say how well it fits. chosen: 6 of 4 and 6: at 4 twice as many pixels err by more than
/// they may.
constexpr int least_records = 6;

/// chosen: looser than where samples of one surface are told apart (see.cpp), since a plane follows normals that change
/// evenly; not tuned.
constexpr float least_normal = 0.95f;
/// Off the surface's plane, in pixels' extents: near, and by pixel of distance. chosen: 0.3 and 0.09, lower than steps
/// that are seen as steps (see.cpp); not tuned.
constexpr float plane_near = 0.3f, plane_slope = 0.09f;
/// Widths of lobes that count as one, and by how much, in units of the width, eyes may lie apart. chosen: what a
/// pixel's neighbours and some frames of a walk turn by lies within.
constexpr float alike_alpha = 0.1f, most_turn = 0.25f;
/// What a lobe's light changes by as the eye turns by its width, as far as `seen_from` does not know.
/// chosen: 0.3, not tuned: residuals see most of it.
constexpr float turn_error = 0.3f;
/// A record so near, in pixels, stands for the pixel by itself where neighbours disagree. chosen: of 0.1, 0.15 and 0.3,
/// at which 3, 7 and 22 % of these pixels err by more than they may.
constexpr float own_distance = 0.1f;
/// Sum of the weights' sizes: 1 within the records' hull. chosen: 1.25, which lets
/// the rim of the picture be served; not tuned.
constexpr float most_stretch = 1.25f;

struct Neighbour {
    glm::vec2 offset;  ///< pixels
    float closeness;   ///< weight in the fit
    const Record* record;
    std::uint32_t index;
    glm::vec3 glossy;  ///< radiance that its light gives the point's lobe
    glm::vec3 light;   ///< that it would give the point: radiance in its pixel
    float turned;      ///< luminance by which that may be off, since the lobe was looked at from elsewhere
};

/// The lobe of a record as the point's eye sees it: what hides and shadows its facets changes with the angle to the
/// normal, for the rest it must be wide [Heitz2014, eq. 99]. `typical`: a cosine of light.
glm::vec3 seen_from(const SurfacePoint& p, const RecordLobe& lobe) {
    constexpr float typical = 0.6f, least = 0.05f;
    const float a2 = p.bsdf.alpha * p.bsdf.alpha;
    const float here = std::max(glm::dot(p.shading_normal, p.outgoing), least),
                there = std::max(glm::dot(p.shading_normal, lobe.outgoing), least);
    const float ratio = lobe::masking(typical, here, a2) / lobe::masking(typical, there, a2);
    return ratio * (p.bsdf.f0 * lobe.f0 + lobe.schlick);
}

class Neighbours {
  public:
    /// Those within `radius` of the query on its surface; false where there are too many or too few.
    bool find(const RecordQuery& q, const RecordMap& map, const Records& records, int radius);
    /// The nearest, if it is the point's own.
    const Neighbour* own() const;
    const Neighbour& nearest() const;
    /// Fits the plane.
    bool fit();
    glm::vec3 mean() const { return plane_[0]; }
    float weight(int i) const { return weights_[static_cast<std::size_t>(i)]; }
    /// What neighbours are off the plane by, as it is noticed: root of the mean square, freedoms counted.
    float residual() const;
    /// What the plane rises by between the point and the nearest record.
    float rise() const;
    /// What gathering may be off by, given what the point makes of irradiance.
    float noise(float receives) const;
    int count() const { return count_; }
    const Neighbour& operator[](int i) const { return found_[static_cast<std::size_t>(i)]; }

  private:
    std::array<Neighbour, most_records> found_;
    std::array<float, most_records> weights_{};
    glm::vec3 plane_[3]{};
    int count_ = 0;
};

bool lies_on(const RecordQuery& q, const RecordMark& m, float distance) {
    const SurfacePoint& p = q.point.point;
    const float alike = glm::dot(p.shading_normal, m.shading_normal);
    if (alike < least_normal || glm::dot(p.geometric_normal, m.geometric_normal) < least_normal) return false;
    const glm::vec3 apart = m.position - p.position;
    const float off =
        std::max(std::abs(glm::dot(apart, p.geometric_normal)), std::abs(glm::dot(apart, m.geometric_normal)));
    // A surface that bends by an angle over a distance leaves its plane by half of their product.
    const float bend = 0.5f * glm::length(apart) * core::sqrt_or_zero(2.0f - 2.0f * alike);
    return off <= q.extent * (plane_near + plane_slope * distance) + bend + p.position_error;
}

bool Neighbours::find(const RecordQuery& q, const RecordMap& map, const Records& records, int radius) {
    count_ = 0;
    const auto reach = static_cast<float>(radius) + 0.5f;
    const int x = static_cast<int>(std::floor(q.at.x)), y = static_cast<int>(std::floor(q.at.y));
    const std::uint32_t surface = surface_of(q.point.point.address, q.point.point.back_side);
    const glm::vec3 reflects = q.point.weight * q.point.point.bsdf.diffuse;
    for (int row = std::max(y - radius, -RecordMap::border);
         row <= std::min(y + radius, map.height() + RecordMap::border - 1); ++row) {
        for (const RecordMark& m : map.row(row, std::max(x - radius, -RecordMap::border),
                                           std::min(x + radius, map.width() + RecordMap::border - 1))) {
            if (m.surface != surface) continue;
            const glm::vec2 offset = m.at - q.at;
            const float distance2 = glm::dot(offset, offset);
            if (distance2 > reach * reach || !lies_on(q, m, std::sqrt(distance2))) continue;
            if (count_ == most_records) return false;
            const Record& r = records[m.record];
            const SurfacePoint& p = q.point.point;
            glm::vec3 glossy(0);
            float turned = 0;
            if (p.bsdf.has_glossy()) {
                const glm::vec3 turn = r.lobe.outgoing - p.outgoing;
                if (!(std::abs(r.lobe.alpha - p.bsdf.alpha) <= alike_alpha * p.bsdf.alpha) ||
                    glm::dot(turn, turn) > most_turn * most_turn * p.bsdf.alpha * p.bsdf.alpha)
                    continue;
                glossy = seen_from(p, r.lobe);
                turned = turn_error / p.bsdf.alpha * glm::length(turn) * core::luminance(q.point.weight * glossy);
            } else if (r.lobe.alpha != 0.0f) {
                continue;
            }
            const float falloff = 1.0f - distance2 / (reach * reach * 1.1f);
            found_[static_cast<std::size_t>(count_++)] = {
                offset, falloff * falloff / (0.25f + distance2),
                &r,     m.record,
                glossy, reflects * (r.direct + r.indirect) + q.point.weight * glossy,
                turned};
        }
    }
    return count_ > 0;
}

const Neighbour& Neighbours::nearest() const {
    return *std::min_element(found_.begin(), found_.begin() + count_, [](const auto& a, const auto& b) {
        return glm::dot(a.offset, a.offset) < glm::dot(b.offset, b.offset);
    });
}

const Neighbour* Neighbours::own() const {
    const Neighbour& n = nearest();
    return glm::dot(n.offset, n.offset) <= own_distance * own_distance ? &n : nullptr;
}

bool Neighbours::fit() {
    if (count_ < least_records) return false;
    // Normal equations of a plane about the point.
    double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
    for (int i = 0; i < count_; ++i) {
        const Neighbour& n = (*this)[i];
        const double w = n.closeness, x = n.offset.x, y = n.offset.y;
        s += w;
        sx += w * x;
        sy += w * y;
        sxx += w * x * x;
        sxy += w * x * y;
        syy += w * y * y;
    }
    const glm::dmat3 moments(s, sx, sy, sx, sxx, sxy, sy, sxy, syy);
    const double determinant = glm::determinant(moments);
    // Records along a line carry no plane: compare with the determinant of records all around, s^3 r^4 / 4.
    if (!(determinant > 1e-3 * s * s * s)) return false;
    const glm::dmat3 inverse = glm::inverse(moments);
    double stretch = 0;
    glm::dvec3 plane[3]{};
    for (int i = 0; i < count_; ++i) {
        const Neighbour& n = (*this)[i];
        const glm::dvec3 row = inverse * glm::dvec3(1.0, n.offset.x, n.offset.y) * static_cast<double>(n.closeness);
        weights_[static_cast<std::size_t>(i)] = static_cast<float>(row.x);
        stretch += std::abs(row.x);
        for (int k = 0; k < 3; ++k) plane[k] += row[k] * glm::dvec3(n.light);
    }
    for (int k = 0; k < 3; ++k) plane_[k] = glm::vec3(plane[k]);
    return stretch <= most_stretch && core::is_finite(plane_[0]);
}

float Neighbours::residual() const {
    // The nearest count for more, but less so than in the plane: an edge just beyond them is near.
    float sum = 0, luminance = 0, red = 0, blue = 0;
    for (int i = 0; i < count_; ++i) {
        const Neighbour& n = (*this)[i];
        const glm::vec3 off = n.light - plane_[0] - n.offset.x * plane_[1] - n.offset.y * plane_[2];
        const float y = core::luminance(off), cr = (off.x - y) / 1.5748f, cb = (off.z - y) / 1.8556f;
        const float w = std::sqrt(n.closeness);
        sum += w;
        luminance += w * y * y;
        red += w * cr * cr;
        blue += w * cb * cb;
    }
    // Chroma counts for half, as everywhere [BT709, 3.3]; three freedoms went into the plane.
    const float square = core::divide_or(std::max(luminance, 0.25f * std::max(red, blue)), sum, 0.0f);
    const auto n = static_cast<float>(count_);
    return std::sqrt(square * n / (n - 3.0f));
}

float Neighbours::rise() const {
    const float slope = std::hypot(core::luminance(plane_[1]), core::luminance(plane_[2]));
    return slope * std::sqrt(glm::dot(nearest().offset, nearest().offset));
}

float Neighbours::noise(float receives) const {
    float square = 0, turned = 0;
    for (int i = 0; i < count_; ++i) {
        turned += std::abs(weight(i)) * (*this)[i].turned;
        const float part = weight(i) * (*this)[i].record->error;
        if (!(*this)[i].record->capped) square += part * part;
    }
    return receives * std::sqrt(square) + turned;
}

PointLight blend(const Neighbours& n) {
    PointLight light;
    glm::vec3 low[3]{glm::vec3(1e30f), glm::vec3(1e30f), glm::vec3(1e30f)}, high[3]{};
    for (int i = 0; i < n.count(); ++i) {
        const Record& r = *n[i].record;
        light.direct += n.weight(i) * r.direct;
        light.indirect += n.weight(i) * r.indirect;
        light.glossy += n.weight(i) * n[i].glossy;
        light.capped = light.capped || r.capped;
        low[0] = glm::min(low[0], r.direct);
        high[0] = glm::max(high[0], r.direct);
        low[1] = glm::min(low[1], r.indirect);
        high[1] = glm::max(high[1], r.indirect);
        low[2] = glm::min(low[2], n[i].glossy);
        high[2] = glm::max(high[2], n[i].glossy);
    }
    light.direct = glm::clamp(light.direct, low[0], high[0]);
    light.indirect = glm::clamp(light.indirect, low[1], high[1]);
    light.glossy = glm::clamp(light.glossy, low[2], high[2]);
    return light;
}

}  // namespace

RecordEstimate estimate(const RecordQuery& q, const RecordMap& map, Records& records, const RecordTrust& trust,
                        std::int64_t frame) {
    RecordEstimate result;
    Neighbours near;
    for (const int radius : radii) {
        result.radius = radius;
        if (!near.find(q, map, records, radius)) continue;
        if (near.fit()) {
            const float tolerance = q.tolerance.allows(core::luminance(near.mean()));
            const float off = trust.residual * near.residual(), noise = trust.noise * near.noise(q.receives);
            const bool steep = radius < tells_steps && trust.step * near.rise() > tolerance;
            if (off <= tolerance && noise <= tolerance && !steep) {
                result.holds = true;
                result.light = blend(near);
                result.light.served = true;
                result.light.error = std::max(off, noise);
                for (int i = 0; i < near.count(); ++i) records.use(near[i].index, frame);
                return result;
            }
        }
        const Neighbour* own = near.own();
        if (own == nullptr) continue;
        const float noise = trust.noise * (q.receives * own->record->error + own->turned);
        if (!own->record->capped && noise > q.tolerance.allows(core::luminance(own->light))) continue;
        result.holds = true;
        result.light.served = true;
        result.light.direct = own->record->direct;
        result.light.indirect = own->record->indirect;
        result.light.glossy = own->glossy;
        result.light.capped = own->record->capped;
        result.light.error = noise;
        records.use(own->index, frame);
        return result;
    }
    return result;
}

}  // namespace render2mpeg::renderer
