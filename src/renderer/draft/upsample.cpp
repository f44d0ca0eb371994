// Joint bilateral upsampling [Herzog2010, 8.2].
#include "renderer/draft/upsample.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// sig_n of eq. 8.2.
constexpr float normal_tolerance = 0.2f;

/// How far a lit point may lie off a point's plane, over its distance to the eye. chosen: 2 %, where the seed takes
/// 3 % of the whole depth range: depth along the axis rejects points of a floor seen at a low angle.
constexpr float plane_tolerance = 0.02f;

/// Floor of each weight [Herzog2010, eq. 8.3]: whatever else lies about, the likest lit point has the say.
constexpr float least_weight = 1e-3f;

/// Part of a weight where the lit point is another object's: at contacts light jumps.
constexpr float other_object = 0.05f;

/// [Herzog2010, eq. 8.3], exponent 3; the exponent by distance is 4, the most of [Herzog2010, 8.3.3], where the past
/// tells more, else 2.
float triweight(float square, float width) {
    const float rest = std::max(least_weight, 1.0f - square / (width * width));
    return rest * rest * rest;
}

}  // namespace

glm::ivec2 lattice_phase(std::int64_t n) {
    static constexpr std::array<int, 16> order{0, 10, 2, 8, 5, 15, 7, 13, 1, 11, 3, 9, 4, 14, 6, 12};
    const int place = order[static_cast<std::size_t>(n % 16)];
    return {place % lattice_step, place / lattice_step};
}

LitPixels lit_pixels_of(std::int64_t n, bool carried) {
    const Windows colour = n % 2 == 0 ? Windows::white : Windows::black;
    return {lattice_phase((n + 1) / 2), carried ? colour : Windows::all};
}

glm::vec3 lobe_reflectance(const GatherPoint& p) {
    if (!p.point.bsdf.has_glossy()) return glm::vec3(0);
    return glossy_albedo(p.point.bsdf, std::max(glm::dot(p.point.shading_normal, p.point.outgoing), 0.0f));
}

Lattice::Lattice(int width, int height, glm::ivec2 phase, Windows windows)
    : across_((width - phase.x + lattice_step - 1) / lattice_step),
      down_((height - phase.y + lattice_step - 1) / lattice_step),
      phase_(phase),
      lit_(windows),
      windows_(static_cast<std::size_t>(std::max(across_, 0)) * static_cast<std::size_t>(std::max(down_, 0))) {}

void Lattice::add(int x, int y, const LitSample& sample) {
    EXPECTS_DEBUG(is_lit(x, y));
    windows_[static_cast<std::size_t>(y / lattice_step) * static_cast<std::size_t>(across_) +
             static_cast<std::size_t>(x / lattice_step)]
        .push_back(sample);
}

Lattice::Interpolated Lattice::at(glm::ivec2 pixel, const GatherPoint& p, bool carries_on, float distance) const {
    return interpolated(pixel, p, 1, carries_on ? 4 : 2, distance);
}

Lattice::Interpolated Lattice::at_from_afar(glm::ivec2 pixel, const GatherPoint& p, float distance) const {
    return interpolated(pixel, p, 2, 2, distance);
}

Lattice::Interpolated Lattice::interpolated(glm::ivec2 pixel, const GatherPoint& p, int reach, int fall_off,
                                            float distance) const {
    // r of [Herzog2010, 8.3.2]: a window's diagonal
    const float radius = static_cast<float>(reach * lattice_step) * 1.4142136f;
    const float column = static_cast<float>(pixel.x - phase_.x) / lattice_step,
                row = static_cast<float>(pixel.y - phase_.y) / lattice_step;
    const int left = static_cast<int>(std::floor(column)), top = static_cast<int>(std::floor(row));
    Interpolated sum;
    float best = 0;
    for (int j = 1 - reach; j <= reach; ++j)
        for (int i = 1 - reach; i <= reach; ++i) {
            if (left + i < 0 || top + j < 0 || left + i >= across_ || top + j >= down_) continue;
            const float dx = (column - static_cast<float>(left + i)) * lattice_step,
                        dy = (row - static_cast<float>(top + j)) * lattice_step;
            const float near = std::max(1.0f - std::sqrt(dx * dx + dy * dy) / radius, 1e-3f);
            const float near_weight = fall_off == 4 ? near * near * near * near : near * near;
            for (const LitSample& s : samples({left + i, top + j})) {
                const float turned = 1.0f - glm::dot(s.normal, p.point.geometric_normal);
                const float off = glm::dot(s.position - p.point.position, p.point.geometric_normal);
                float weight = near_weight * triweight(turned * turned, normal_tolerance) *
                               triweight(off * off, plane_tolerance * distance);
                if (s.object != p.point.address.object || s.path != p.path) weight *= other_object;
                best = std::max(best, weight / near_weight);
                sum.light.irradiance += weight * s.light.irradiance;
                sum.light.glossy += weight * s.light.glossy;
                sum.weight += weight;
            }
        }
    sum.is_empty = sum.weight <= 0;
    if (!sum.is_empty) {
        sum.light.irradiance /= sum.weight;
        sum.light.glossy /= sum.weight;
    }
    // Light told by unlike points only weighs next to nothing.
    sum.weight = best < 0.01f ? 0.0f : sum.weight;
    return sum;
}

}  // namespace render2mpeg::renderer
