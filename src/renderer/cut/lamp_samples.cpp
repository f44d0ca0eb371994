#include "renderer/cut/lamp_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/isa_clones.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Element `i` of the (0, 2)-sequence of Sobol: aligned runs of 4, 16 and 64 are stratified in both dimensions and
/// jointly [Sobol1967].
glm::vec2 sobol(std::uint32_t i) {
    std::uint32_t x = 0, y = 0, first = 0x80000000u, second = 0x80000000u;
    for (; i != 0; i >>= 1, first >>= 1, second ^= second >> 1) {
        if ((i & 1u) == 0) continue;
        x ^= first;
        y ^= second;
    }
    return {(static_cast<float>(x >> 8) + 0.5f) * 0x1p-24f, (static_cast<float>(y >> 8) + 0.5f) * 0x1p-24f};
}

/// A disc of radius 1, evenly, so that strata stay compact [Shirley1997].
glm::vec2 on_disc(glm::vec2 u) {
    const glm::vec2 p = 2.0f * u - 1.0f;
    if (p == glm::vec2(0)) return p;
    constexpr float quarter = std::numbers::pi_v<float> / 4;
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const float r = wide ? p.x : p.y, turn = wide ? quarter * (p.y / p.x) : 2 * quarter - quarter * (p.x / p.y);
    return r * glm::vec2(std::cos(turn), std::sin(turn));
}

/// All samples: of a square, and of a disc.
struct Pattern {
    std::array<glm::vec2, most_lamp_samples> square, disc;
};
const Pattern pattern = [] {
    Pattern p;
    for (std::uint32_t i = 0; i < p.square.size(); ++i) {
        p.square[i] = sobol(i);
        p.disc[i] = on_disc(p.square[i]);
    }
    return p;
}();

/// Which sample a lane of a group takes as its k-th: the aligned runs of 4, 16, 64, 256 about a place of its own. The
/// sixty-fours of sixteen lanes are all samples, and their fours lie in all parts of the lamp. Groups of other sets of
/// representatives begin elsewhere.
std::size_t sample_index(int set, int lane, int k) {
    const int turned = (lane + 4 * set) & (lane_count - 1);
    const int own = 64 * turned + 4 * ((turned * 5 + turned / 4) & (lane_count - 1));
    return static_cast<std::size_t>(own ^ k);
}

bool is_parallelogram(const std::vector<glm::vec3>& c) {
    return c.size() == 4 && glm::length(c[0] + c[2] - c[1] - c[3]) <= 1e-4f * glm::length(c[2] - c[0]);
}

/// A place on a convex polygon, evenly.
glm::vec3 on_polygon(const std::vector<glm::vec3>& c, glm::vec2 u) {
    float area = 0;
    for (std::size_t i = 2; i < c.size(); ++i) area += glm::length(glm::cross(c[i - 1] - c[0], c[i] - c[0]));
    float left = u.x * area;
    for (std::size_t i = 2; i < c.size(); ++i) {
        const glm::vec3 a = c[i - 1] - c[0], b = c[i] - c[0];
        const float part = glm::length(glm::cross(a, b));
        if (left > part && i + 1 < c.size()) {
            left -= part;
            continue;
        }
        const glm::vec2 uv = core::sample_triangle({core::divide_or(std::min(left, part), part, 0.0f), u.y});
        return c[0] + uv.x * a + uv.y * b;
    }
    return c[0];
}

void put(Vec3Lanes& lanes, int i, glm::vec3 v) {
    lanes.x[i] = v.x;
    lanes.y[i] = v.y;
    lanes.z[i] = v.z;
}

RENDER2MPEG_ALWAYS_INLINED float dot(const Vec3Lanes& a, const Vec3Lanes& b, int i) {
    return a.x[i] * b.x[i] + a.y[i] * b.y[i] + a.z[i] * b.z[i];
}

/// A function of its own, since a loop of lanes within one of corners does not become vector code.
RENDER2MPEG_CLONES
void lower(const Vec3Lanes& __restrict edge, const Vec3Lanes& __restrict direction, Lanes& __restrict least) {
    for (int i = 0; i < lane_count; ++i) least[i] = inlined::min(least[i], dot(edge, direction, i));
}

}  // namespace

LampSampler::LampSampler(const AreaLamp& lamp, const GatherLanes& lanes) : lamp_(lamp), lanes_(lanes) {
    if (lamp.kind == AreaLamp::Kind::polygon)
        start_polygon();
    else
        start_cone();
    if (lanes.glossy) start_lobes();
}

void LampSampler::start_polygon() {
    const std::vector<glm::vec3>& c = lamp_.corners;
    EXPECTS(c.size() <= most_lamp_corners);
    even_ = is_parallelogram(c);
    for (int i = 0; i < lane_count; ++i) {
        const glm::vec3 place = lanes_.position.at(i);
        height_[i] = glm::dot(place - c[0], lamp_.normal);
        for (std::size_t k = 0; k < c.size(); ++k) {
            // The next corners but one lie within.
            const glm::vec3 across = glm::cross(c[k] - place, c[(k + 1) % c.size()] - place);
            const float side = glm::dot(across, c[(k + 2) % c.size()] - place);
            put(edges_[k], i, side < 0 ? -across : across);
        }
    }
}

void LampSampler::start_cone() {
    for (int i = 0; i < lane_count; ++i) {
        glm::vec3 axis = lamp_.position, tangent, bitangent;
        float sine = lamp_.radius;
        if (lamp_.kind == AreaLamp::Kind::sphere) {
            const glm::vec3 to_lamp = lamp_.position - lanes_.position.at(i);
            distance_[i] = std::max(glm::length(to_lamp), lamp_.radius * 1.0001f);
            sine = lamp_.radius / distance_[i];
            axis = core::normalize_or(to_lamp, {0, 0, 1});
        }
        core::make_frame(axis, tangent, bitangent);
        put(axis_, i, axis);
        put(tangent_, i, tangent);
        put(bitangent_, i, bitangent);
        lowered_[i] = sine * sine / (1 + core::sqrt_or_zero(1 - sine * sine));
    }
}

void LampSampler::start_lobes() {
    const FrameLanes& n = lanes_.normal;
    for (int i = 0; i < lane_count; ++i) {
        const glm::vec3 out = lanes_.outgoing.axis.at(i);
        const glm::vec3 o = glm::normalize(
            glm::vec3(glm::dot(n.tangent.at(i), out), glm::dot(n.bitangent.at(i), out), lanes_.cos_outgoing[i]));
        alpha_[i] = std::sqrt(lanes_.lobe_width[i]);
        const glm::vec3 v = glm::normalize(glm::vec3(alpha_[i] * o.x, alpha_[i] * o.y, o.z));
        const float across2 = v.x * v.x + v.y * v.y;
        const glm::vec3 t = across2 > 0.0f ? glm::vec3(-v.y, v.x, 0) / std::sqrt(across2) : glm::vec3(1, 0, 0);
        put(outgoing_, i, o);
        put(facets_.axis, i, v);
        put(facets_.tangent, i, t);
        put(facets_.bitangent, i, glm::cross(v, t));
        hidden_[i] = 0.5f * (1.0f + v.z);
    }
}

LampSampler::Numbers LampSampler::numbers(std::span<const glm::vec2> all, int k) const {
    Numbers u;
    for (int i = 0; i < lane_count; ++i) {
        const glm::vec2 p = all[sample_index(lanes_.set, i, k)];
        u.x[i] = p.x;
        u.y[i] = p.y;
    }
    return u;
}

void LampSampler::take(int k, LampSamples& __restrict samples) const {
    if (lamp_.kind == AreaLamp::Kind::polygon)
        take_polygon(numbers(pattern.square, k), samples);
    else
        take_cone(numbers(pattern.disc, k), samples);
}

/// Parallelograms keep the strata. Density by solid angle of a place at distance d on a plane at height h: d^2 / (area
/// h / d).
RENDER2MPEG_CLONES
void LampSampler::take_polygon(const Numbers& u, LampSamples& __restrict samples) const {
    const std::vector<glm::vec3>& c = lamp_.corners;
    Vec3Lanes place;
    if (even_) {
        const glm::vec3 a = c[1] - c[0], b = c[3] - c[0];
        for (int i = 0; i < lane_count; ++i) {
            place.x[i] = c[0].x + u.x[i] * a.x + u.y[i] * b.x;
            place.y[i] = c[0].y + u.x[i] * a.y + u.y[i] * b.y;
            place.z[i] = c[0].z + u.x[i] * a.z + u.y[i] * b.z;
        }
    } else {
        for (int i = 0; i < lane_count; ++i) put(place, i, on_polygon(c, {u.x[i], u.y[i]}));
    }
    for (int i = 0; i < lane_count; ++i) {
        const float x = place.x[i] - lanes_.position.x[i], y = place.y[i] - lanes_.position.y[i];
        const float z = place.z[i] - lanes_.position.z[i];
        const float inverse = 1.0f / inlined::sqrt(inlined::max(x * x + y * y + z * z, lobe::tiny));
        samples.direction.x[i] = x * inverse;
        samples.direction.y[i] = y * inverse;
        samples.direction.z[i] = z * inverse;
        samples.inverse_density[i] = lamp_.area * inlined::abs(height_[i]) * inverse * inverse * inverse;
    }
}

/// Evenly by solid angle: 1 - cos grows as the disc's squared radius.
RENDER2MPEG_CLONES
void LampSampler::take_cone(const Numbers& disc, LampSamples& __restrict samples) const {
    for (int i = 0; i < lane_count; ++i) {
        const float most = lowered_[i], lowered = most * (disc.x[i] * disc.x[i] + disc.y[i] * disc.y[i]);
        const float scale = inlined::sqrt(inlined::max(most * (2.0f - lowered), 0.0f));
        const float along = 1.0f - lowered, x = scale * disc.x[i], y = scale * disc.y[i];
        samples.direction.x[i] = along * axis_.x[i] + x * tangent_.x[i] + y * bitangent_.x[i];
        samples.direction.y[i] = along * axis_.y[i] + x * tangent_.y[i] + y * bitangent_.y[i];
        samples.direction.z[i] = along * axis_.z[i] + x * tangent_.z[i] + y * bitangent_.z[i];
        samples.inverse_density[i] = 2.0f * std::numbers::pi_v<float> * most;
    }
}

void LampSampler::start_at(int k, Vec3Lanes& origin) const {
    if (lanes_.places == 1) {
        origin = lanes_.origin;
        return;
    }
    for (int i = 0; i < lane_count; ++i) {
        // All digits of the sample's number to the base 4 decide.
        std::size_t place = 0;
        for (std::size_t left = sample_index(lanes_.set, i, k); left > 0; left >>= 2) place ^= left & 3u;
        const Vec3Lanes& from = origins(lanes_, static_cast<int>(place) % lanes_.places);
        origin.x[i] = from.x[i];
        origin.y[i] = from.y[i];
        origin.z[i] = from.z[i];
    }
}

void LampSampler::aim(const LampSamples& samples, Vec3Lanes& targets) const {
    switch (lamp_.kind) {
        case AreaLamp::Kind::polygon:
            return aim_at_polygon(samples.direction, targets);
        case AreaLamp::Kind::sphere:
            return aim_at_sphere(samples.direction, targets);
        case AreaLamp::Kind::sun:
            targets = samples.direction;
    }
}

RENDER2MPEG_CLONES
void LampSampler::aim_at_polygon(const Vec3Lanes& __restrict direction, Vec3Lanes& __restrict targets) const {
    const float nx = lamp_.normal.x, ny = lamp_.normal.y, nz = lamp_.normal.z, clearance = lamp_.clearance;
    for (int i = 0; i < lane_count; ++i) {
        const float slope = nx * direction.x[i] + ny * direction.y[i] + nz * direction.z[i];
        const float far = inlined::abs(height_[i]) / inlined::max(inlined::abs(slope), lobe::tiny);
        const float lift = height_[i] < 0.0f ? -clearance : clearance;
        targets.x[i] = lanes_.position.x[i] + far * direction.x[i] + lift * nx;
        targets.y[i] = lanes_.position.y[i] + far * direction.y[i] + lift * ny;
        targets.z[i] = lanes_.position.z[i] + far * direction.z[i] + lift * nz;
    }
}

/// Rays end where they enter the sphere.
RENDER2MPEG_CLONES
void LampSampler::aim_at_sphere(const Vec3Lanes& __restrict direction, Vec3Lanes& __restrict targets) const {
    const float outer = lamp_.radius + lamp_.clearance, outer2 = outer * outer;
    for (int i = 0; i < lane_count; ++i) {
        const float far = distance_[i], along = far * dot(axis_, direction, i);
        const float x = far * axis_.x[i] - along * direction.x[i], y = far * axis_.y[i] - along * direction.y[i];
        const float z = far * axis_.z[i] - along * direction.z[i];
        const float within = inlined::sqrt(inlined::max(outer2 - (x * x + y * y + z * z), 0.0f));
        const float enters = inlined::max(along - within, 0.0f);
        targets.x[i] = lanes_.position.x[i] + enters * direction.x[i];
        targets.y[i] = lanes_.position.y[i] + enters * direction.y[i];
        targets.z[i] = lanes_.position.z[i] + enters * direction.z[i];
    }
}

RENDER2MPEG_CLONES
void LampSampler::take_lobe(int k, LampSamples& __restrict samples) const {
    const Numbers u = numbers(pattern.disc, k);
    const FrameLanes &f = facets_, &n = lanes_.normal;
    for (int i = 0; i < lane_count; ++i) {
        const float a = u.x[i], s = hidden_[i], upright = inlined::sqrt(inlined::max(1.0f - a * a, 0.0f));
        const float b = upright + s * (u.y[i] - upright), c = inlined::sqrt(inlined::max(1.0f - a * a - b * b, 0.0f));
        float hx = alpha_[i] * (a * f.tangent.x[i] + b * f.bitangent.x[i] + c * f.axis.x[i]);
        float hy = alpha_[i] * (a * f.tangent.y[i] + b * f.bitangent.y[i] + c * f.axis.y[i]);
        float hz = inlined::max(a * f.tangent.z[i] + b * f.bitangent.z[i] + c * f.axis.z[i], 1e-6f);
        const float inverse = 1.0f / inlined::sqrt(hx * hx + hy * hy + hz * hz);
        hx *= inverse;
        hy *= inverse;
        hz *= inverse;
        const float twice = 2.0f * (outgoing_.x[i] * hx + outgoing_.y[i] * hy + outgoing_.z[i] * hz);
        const float x = twice * hx - outgoing_.x[i], y = twice * hy - outgoing_.y[i], z = twice * hz - outgoing_.z[i];
        samples.direction.x[i] = x * n.tangent.x[i] + y * n.bitangent.x[i] + z * n.axis.x[i];
        samples.direction.y[i] = x * n.tangent.y[i] + y * n.bitangent.y[i] + z * n.axis.y[i];
        samples.direction.z[i] = x * n.tangent.z[i] + y * n.bitangent.z[i] + z * n.axis.z[i];
    }
    if (lamp_.kind == AreaLamp::Kind::polygon)
        meet_polygon(samples);
    else
        meet_cone(samples);
}

RENDER2MPEG_CLONES
void LampSampler::meet_polygon(LampSamples& __restrict samples) const {
    const float nx = lamp_.normal.x, ny = lamp_.normal.y, nz = lamp_.normal.z, area = lamp_.area;
    alignas(64) Lanes least;
    for (int i = 0; i < lane_count; ++i) {
        const float slope = nx * samples.direction.x[i] + ny * samples.direction.y[i] + nz * samples.direction.z[i];
        least[i] = height_[i] < 0.0f ? slope : -slope;
        const float height2 = inlined::max(height_[i] * height_[i], lobe::tiny);
        samples.inverse_density[i] = area * inlined::abs(slope * slope * slope) / height2;
    }
    const std::size_t corners = lamp_.corners.size();
    for (std::size_t k = 0; k < corners; ++k) lower(edges_[k], samples.direction, least);
    for (int i = 0; i < lane_count; ++i)
        samples.inverse_density[i] = least[i] > 0.0f ? samples.inverse_density[i] : 0.0f;
}

/// By the chord, since cosines of narrow cones have no digits.
RENDER2MPEG_CLONES
void LampSampler::meet_cone(LampSamples& __restrict samples) const {
    for (int i = 0; i < lane_count; ++i) {
        const Vec3Lanes& d = samples.direction;
        const float x = d.x[i] - axis_.x[i], y = d.y[i] - axis_.y[i], z = d.z[i] - axis_.z[i];
        const bool meets = x * x + y * y + z * z <= 2.0f * lowered_[i];
        samples.inverse_density[i] = meets ? 2.0f * std::numbers::pi_v<float> * lowered_[i] : 0.0f;
    }
}

}  // namespace render2mpeg::renderer
