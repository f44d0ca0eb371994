#include "record_gradients_fits.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/cache/record_plane.h"

namespace render2mpeg::bench {
namespace {

using renderer::RecordPlane;

/// As record_plane.cpp weighs what is off.
float noticed(glm::vec3 off) {
    const float y = core::luminance(off);
    return std::max(std::abs(y), 0.5f * std::max(std::abs(off.x - y) / 1.5748f, std::abs(off.z - y) / 1.8556f));
}

/// renderer/record_fit.cpp, Neighbours::fit: a plane, or a mean with its further doubts.
Guess guess_by(RecordPlane& plane) {
    constexpr int least_level = 4;
    constexpr float level_doubt = 3.0f, level_distance = 1.5f, most_reach = 4.0f;
    Guess g;
    if (plane.count() == 0) return g;
    if (plane.fit()) {
        g.found = true;
        g.off = plane.residual();
    } else if (plane.count() >= least_level && plane.distance(plane.nearest()) <= level_distance && plane.fit_level() &&
               plane.reach() < most_reach) {
        g.found = g.level = true;
        g.off = level_doubt * std::max(1.0f, plane.reach()) * plane.residual();
    }
    g.value = plane.value();
    return g;
}

/// A plane of least squares through what records say when their gradients are followed for shares of the way; held
/// within what they say.
Guess by_plane(const Place& p, const std::vector<Near>& near, float way, float turn) {
    RecordPlane plane;
    glm::vec3 low(1e30f), high(0);
    for (const Near& n : near) {
        if (plane.is_full()) return {};
        const glm::vec3 value = told(n, p, way, turn);
        plane.add(n.offset, n.closeness, value);
        low = glm::min(low, value);
        high = glm::max(high, value);
    }
    Guess g = guess_by(plane);
    if (g.found) g.value = glm::clamp(g.value, low, high);
    return g;
}

/// As record_fit.cpp: planes of values taken halfway, means of those taken all the way.
Guess by_halfway(const Place& p, const std::vector<Near>& near) {
    const Guess g = by_plane(p, near, 0.5f, 1);
    return g.level ? by_plane(p, near, 1, 1) : g;
}

/// Weighted mean of `values`, which disagree as RecordPlane has it, one freedom counted.
Guess by_mean(const std::vector<Near>& near, const std::vector<glm::vec3>& values, const std::vector<float>& weights,
              int least) {
    Guess g;
    const auto n = static_cast<float>(near.size());
    if (static_cast<int>(near.size()) < std::max(least, 2)) return g;
    float sum = 0, roots = 0, square = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
        sum += weights[i];
        g.value += weights[i] * values[i];
    }
    g.value *= core::divide_or(1.0f, sum, 0.0f);
    for (std::size_t i = 0; i < near.size(); ++i) {
        const float off = noticed(values[i] - g.value), w = std::sqrt(near[i].closeness);
        roots += w;
        square += w * off * off;
    }
    g.found = sum > 0.0f && core::is_finite(g.value);
    g.off = std::sqrt(core::divide_or(square, roots, 0.0f) * n / (n - 1.0f));
    return g;
}

/// [Render2MPEG, eq. 6.29]: semi-axes along and across the gradient, held at 0.3; 1 where light changes by a tenth
/// over a step. chosen: of 0.05, 0.1 and 0.2; the seed leaves it to the user.
glm::vec3 stretched(const Near& n, const Place& p, glm::vec3 way) {
    constexpr float mu = 0.1f, least = 0.3f;
    const glm::vec3 y = core::luminance_weights * glm::mat3(n.record->by_place);
    glm::vec3 slope = y - glm::dot(y, n.normal) * n.normal;
    const float steep = glm::length(slope);
    if (!(steep > 0.0f)) return way;
    slope /= steep;
    const float x = core::divide_or(steep * p.step, core::luminance(n.record->light), 0.0f);
    const float g = std::max(least, 1.0f / (1.0f + x * x / (mu * mu)));
    const float along = glm::dot(way, slope);
    const glm::vec3 across = way - along * slope;
    return along / g * slope + g * across;
}

/// Ward's weights, as [Render2MPEG, eq. 6.27] has them, of records whose clearance is held between one step of the
/// lattice and ten.
Guess by_gradients(const Place& p, const std::vector<Near>& near, int least, bool stretch) {
    std::vector<glm::vec3> values;
    std::vector<float> weights;
    for (const Near& n : near) {
        glm::vec3 way = p.position - n.position;
        if (stretch) way = stretched(n, p, way);
        const float radius = std::clamp(n.record->clearance, p.step, 10.0f * p.step);
        const float apart = glm::length(way) / radius, turned = core::sqrt_or_zero(1.0f - glm::dot(p.normal, n.normal));
        values.push_back(told(n, p, 1, 1));
        weights.push_back(1.0f / std::max(apart + turned, 1e-3f));
    }
    return by_mean(near, values, weights, least);
}

Guess by_level(const Place& p, const std::vector<Near>& near, int least) {
    std::vector<glm::vec3> values;
    std::vector<float> weights;
    for (const Near& n : near) {
        values.push_back(told(n, p, 0, 0));
        weights.push_back(n.closeness);
    }
    return by_mean(near, values, weights, least);
}

/// Each record gives two observations: what it has where it lies, and what it says of the place.
Guess by_observations(const Place& p, const std::vector<Near>& near) {
    RecordPlane plane;
    for (const Near& n : near) {
        if (plane.count() + 2 > RecordPlane::most) return {};
        plane.add(n.offset, n.closeness, told(n, p, 0, 1));
        plane.add(glm::vec2(0), n.closeness, told(n, p, 1, 1));
    }
    Guess g;
    if (plane.count() == 0 || !plane.fit()) return g;
    g.found = true;
    g.value = glm::max(plane.value(), glm::vec3(0));
    g.off = plane.residual();
    return g;
}

/// A plane alone, without means of its own.
Guess by_plane_or(const Place& p, const std::vector<Near>& near, float way, const Guess& other) {
    Guess g = by_plane(p, near, way, way > 0 ? 1 : 0);
    if (g.found && !g.level) return g;
    g = other;
    g.instead = true;
    return g;
}

}  // namespace

glm::vec3 told(const Near& n, const Place& p, float way, float turn) {
    const SlopedLight& r = *n.record;
    const glm::vec3 light =
        r.light + r.by_place * (way * (p.position - n.position)) + r.by_normal * (turn * (p.normal - n.normal));
    return p.reflects * glm::max(light, glm::vec3(0));
}

Guess guess(Method method, const Place& p, const std::vector<Near>& near, int least) {
    switch (method) {
        case Method::mean:
            return by_level(p, near, least);
        case Method::plane:
            return by_plane(p, near, 0, 0);
        case Method::turned:
            return by_plane(p, near, 0, 1);
        case Method::halfway:
            return by_halfway(p, near);
        case Method::gradients:
            return by_gradients(p, near, least, false);
        case Method::stretched:
            return by_gradients(p, near, least, true);
        case Method::hermite:
            return by_observations(p, near);
        case Method::plane_or_mean:
            return by_plane_or(p, near, 0, by_level(p, near, least));
        case Method::plane_or_gradients:
            return by_plane_or(p, near, 0, by_gradients(p, near, least, false));
        case Method::halfway_or_gradients:
            return by_plane_or(p, near, 0.5f, by_gradients(p, near, least, false));
        case Method::seconded:
            break;
    }
    Guess g = by_plane(p, near, 0, 0);
    const Guess second = by_gradients(p, near, least, false);
    if (g.found && second.found) g.off = std::max(g.off, noticed(g.value - second.value));
    return g;
}

}  // namespace render2mpeg::bench
