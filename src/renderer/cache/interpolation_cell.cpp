#include "renderer/cache/interpolation_cell.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Of the twist of a cell, what light may be off in its midst: what it is where light bends along one diagonal
/// alone. Not tuned.
constexpr float twist_share = 0.25f;

/// Where no record lies in the midst of a cell, a step from side to side looks like a slope, as in planes of two
/// columns. In sides, what is no longer in the midst: 0.2, within a pixel of an edge of 4; not tuned.
constexpr float midst = 0.2f;

/// Points are taken to lie so far beyond the corners at most, in sides of 4 pixels: a pixel, since they lie anywhere in
/// theirs. Not tuned.
constexpr float most_beyond = 0.25f;

/// What differences of at most so much in each colour are noticed as at most, whatever their signs (core::noticed).
float noticed_at_most(glm::vec3 d) {
    const float red = (0.7874f * d.x + 0.7152f * d.y + 0.0722f * d.z) / 1.5748f,
                blue = (0.2126f * d.x + 0.7152f * d.y + 0.9278f * d.z) / 1.8556f;
    return std::max(core::luminance(d), 0.5f * std::max(red, blue));
}

}  // namespace

glm::vec2 InterpolationCell::place_of(glm::vec2 p) const {
    const glm::vec2 a = marks_[0].at, b = marks_[1].at, c = marks_[2].at, d = marks_[3].at;
    const auto within = [](float x, float first, float last) {
        return std::clamp(core::divide_or(x - first, last - first, 0.5f), -most_beyond, 1.0f + most_beyond);
    };
    // Points lie somewhere in their pixels, so that sides are nearly parallel: two rounds are enough.
    float y = within(p.y, a.y, c.y), x = 0;
    for (int round = 0; round < 2; ++round) {
        x = within(p.x, glm::mix(a.x, c.x, y), glm::mix(b.x, d.x, y));
        y = within(p.y, glm::mix(a.y, b.y, x), glm::mix(c.y, d.y, x));
    }
    return {x, y};
}

std::optional<InterpolationCell> InterpolationCell::between(const std::array<CellCorner, 4>& corners, int side,
                                                            const RecordGrid& grid, RecordStore& records,
                                                            std::int64_t frame) {
    InterpolationCell s;
    const float extent = corners[0].extent;
    if (!grid.reaches(corners[0].mark.at, side)) return std::nullopt;
    s.residual_factor_ = corners[0].residual_factor;
    for (std::size_t k = 0; k < 4; ++k) {
        const CellCorner& c = corners[k];
        const float apart = extent * glm::length(c.mark.at - corners[0].mark.at);
        if (!on_one_surface(corners[0].mark, c.mark, apart, extent) || !(c.receives > 0.0f && c.reflects > 0.0f))
            return std::nullopt;
        s.marks_[k] = c.mark;
        s.direct_[k] = c.light->direct;
        s.indirect_[k] = c.light->indirect;
        s.clamped_[k] = core::divide_or(c.light->clamped, c.scattered, 0.0f);
        s.age_[k] = c.light->age;
        s.error_ = std::max(s.error_, c.light->error / c.receives);
        s.disagreement_ = std::max(s.disagreement_, c.light->cache_error * c.allowed / c.reflects);
        s.residual_factor_ = std::min(s.residual_factor_, c.residual_factor);
        s.capped_ = s.capped_ || c.light->capped;
    }
    const auto& m = s.marks_;
    const float least = 0.5f * static_cast<float>(side);
    if (!(std::min(m[1].at.x - m[0].at.x, m[3].at.x - m[2].at.x) > least &&
          std::min(m[2].at.y - m[0].at.y, m[3].at.y - m[1].at.y) > least))
        return std::nullopt;
    s.estimate_error(side, extent, grid, records, frame);
    return s;
}

void InterpolationCell::estimate_error(int side, float extent, const RecordGrid& grid, RecordStore& records,
                                       std::int64_t frame) {
    std::array<glm::vec3, 4> light;
    for (std::size_t k = 0; k < 4; ++k) light[k] = direct_[k] + indirect_[k];
    glm::vec3 sum2(0);
    int count = 0;
    glm::vec2 has_record(0);  // of a step across x and across y: 1 or 0
    const glm::ivec2 first = glm::floor(marks_[0].at);
    constexpr int border = RecordGrid::border;
    for (int y = std::max(first.y, -border); y <= std::min(first.y + side, grid.height() + border - 1); ++y) {
        for (const SurfaceMark& m :
             grid.row(y, std::max(first.x, -border), std::min(first.x + side, grid.width() + border - 1))) {
            const IrradianceRecord& r = records[m.record];
            if (r.lobe.alpha > 0.0f || !on_one_surface(marks_[0], m, extent * glm::length(m.at - marks_[0].at), extent))
                continue;
            const glm::vec2 place = place_of(m.at);
            const glm::vec3 off = r.direct + r.indirect - at(place, light);
            sum2 += off * off;
            ++count;
            has_record = glm::max(has_record, glm::vec2(place.x > midst && place.x < 1.0f - midst ? 1 : 0,
                                                        place.y > midst && place.y < 1.0f - midst ? 1 : 0));
            records.mark_used(m.record, frame);
        }
    }
    // What light at the corners is off a plane, as far as that is not because they are no parallelogram.
    const auto& m = marks_;
    const glm::vec2 skew = m[0].at - m[1].at - m[2].at + m[3].at;
    const glm::vec3 across =
        (light[1] - light[0] + light[3] - light[2]) / (m[1].at.x - m[0].at.x + m[3].at.x - m[2].at.x);
    const glm::vec3 down =
        (light[2] - light[0] + light[3] - light[1]) / (m[2].at.y - m[0].at.y + m[3].at.y - m[1].at.y);
    const glm::vec3 twist = light[0] - light[1] - light[2] + light[3] - skew.x * across - skew.y * down;
    const glm::vec3 step_x = glm::max(glm::abs(light[1] - light[0]), glm::abs(light[3] - light[2])),
                    step_y = glm::max(glm::abs(light[2] - light[0]), glm::abs(light[3] - light[1]));
    off_ =
        glm::max(count > 0 ? glm::sqrt(sum2 / static_cast<float>(count)) : glm::vec3(0), twist_share * glm::abs(twist));
    rise_ = 0.5f * glm::max((1.0f - has_record.x) * step_x, (1.0f - has_record.y) * step_y);
}

bool InterpolationCell::interpolate(const CacheQuery& q, const CacheErrorModel& model, PointLight& light) const {
    const SurfacePoint& p = q.point.point;
    const SurfaceMark here = mark_of(q);
    for (const std::size_t k : {0u, 3u})
        if (!on_one_surface(here, marks_[k], q.extent * glm::length(q.at - marks_[k].at), q.extent, p.position_error))
            return false;
    const glm::vec2 place = place_of(q.at);
    // Beyond the corners there is no more, nor less, than at one of them.
    const auto within = [&](const std::array<glm::vec3, 4>& c) {
        return glm::clamp(at(place, c), glm::min(glm::min(c[0], c[1]), glm::min(c[2], c[3])),
                          glm::max(glm::max(c[0], c[1]), glm::max(c[2], c[3])));
    };
    const glm::vec3 direct = within(direct_), indirect = within(indirect_);
    // Where normals turn otherwise than from corner to corner, light does.
    std::array<glm::vec3, 4> normals;
    for (std::size_t k = 0; k < 4; ++k) normals[k] = marks_[k].shading_normal;
    const float turned = glm::length(at(place, normals) - p.shading_normal);
    const glm::vec3 reflects = q.point.weight * p.bsdf.diffuse;
    const float sent = core::luminance(reflects * (direct + indirect));
    const float tolerance = q.tolerance.allows(sent);
    const float factor = residual_factor(q.tolerance, sent, tolerance);
    const float off = model.residual * factor * (noticed_at_most(reflects * off_) + turned * sent);
    // The corners' disagreement is by their own tolerances.
    const float rise = model.step * noticed_at_most(reflects * rise_),
                disagreement =
                    std::max({off, rise, std::max(1.0f, factor / residual_factor_) * q.receives * disagreement_}),
                error = q.receives * error_;
    if (!(std::max(model.cache_error_scale * disagreement, error) <= tolerance)) return false;
    light = {direct, indirect};
    light.served = true;
    light.clamped = std::max(at(place, clamped_), 0.0f) * sent;
    light.age = std::max(at(place, age_), 0.0f);
    light.capped = capped_;
    light.cache_error = core::divide_or(disagreement, tolerance, 0.0f);
    light.error = std::max(model.cache_error_scale * disagreement, error);
    return true;
}

}  // namespace render2mpeg::renderer
