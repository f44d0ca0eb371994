#include "scene/animation_file/curve.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace render2mpeg::scene {
namespace {

double value_at(const Curve& c, std::size_t key, int component) {
    return c.values[key * static_cast<std::size_t>(c.width) + static_cast<std::size_t>(component)];
}

/// Slope between two keys.
double secant(const Curve& c, std::size_t key, int component) {
    return (value_at(c, key + 1, component) - value_at(c, key, component)) / (c.times[key + 1] - c.times[key]);
}

/// Derivative of the parabola through a key and its neighbours (Catmull-Rom for uneven times), or the secant at the
/// ends. [Catmull1974]
double tangent(const Curve& c, std::size_t key, int component) {
    const std::size_t n = c.times.size();
    if (n < 2 || c.passage == Passage::ease) return 0;
    if (key == 0) return secant(c, 0, component);
    if (key + 1 == n) return secant(c, n - 2, component);
    const double before = secant(c, key - 1, component), after = secant(c, key, component);
    // Equal keys stay equal between them: a thing at rest must not swing back before it leaps.
    if (before == 0 || after == 0) return 0;
    const double h0 = c.times[key] - c.times[key - 1], h1 = c.times[key + 1] - c.times[key];
    const double slope = (before * h1 + after * h0) / (h0 + h1);
    if (!c.monotone) return slope;
    // A cubic stays between its keys while its slopes are at most three times the secant's. [Fritsch1980]
    if (before * after <= 0) return 0;
    const double limit = 3 * std::min(std::abs(before), std::abs(after));
    return std::clamp(slope, -limit, limit);
}

double angle_between(const glm::dquat& a, const glm::dquat& b) {
    // Twice the arc sine of half the chord keeps its digits for small angles, where the arc cosine has none.
    const double sign = glm::dot(a, b) < 0 ? -1 : 1;
    const glm::dquat d(a.w - sign * b.w, a.x - sign * b.x, a.y - sign * b.y, a.z - sign * b.z);
    return 4 * std::asin(std::min(1.0, 0.5 * glm::length(d)));
}

/// Keys between `t0` and `t1`, the ends excluded, in rising order.
void densify(const std::function<glm::dquat(double)>& rotation_at, double t0, const glm::dquat& q0, double t1,
             const glm::dquat& q1, int depth, std::vector<std::pair<double, glm::dquat>>& out) {
    // A motion that is symmetric about the middle hides from a test there: look at two places more.
    bool straight = angle_between(q0, q1) < 0.5;
    for (const double f : {0.5, 0.3, 0.7})
        straight = straight && angle_between(rotation_at(t0 + f * (t1 - t0)),
                                             glm::slerp(q0, glm::dot(q0, q1) < 0 ? -q1 : q1, f)) < 2e-5;
    if (straight || depth == 0) return;
    const double middle = 0.5 * (t0 + t1);
    const glm::dquat q = rotation_at(middle);
    densify(rotation_at, t0, q0, middle, q, depth - 1, out);
    out.emplace_back(middle, q);
    densify(rotation_at, middle, q, t1, q1, depth - 1, out);
}

}  // namespace

void Curve::add(double time, std::span<const double> value) {
    EXPECTS(value.size() == static_cast<std::size_t>(width));
    EXPECTS(times.empty() || time > times.back());
    times.push_back(time);
    values.insert(values.end(), value.begin(), value.end());
}

void Curve::sample(double seconds, std::span<double> out) const {
    EXPECTS(!times.empty());
    const std::size_t after =
        static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
    const std::size_t key = after == 0 ? 0 : after - 1;
    for (int i = 0; i < width; ++i) {
        double& v = out[static_cast<std::size_t>(i)];
        v = value_at(*this, key, i);
        if (after == 0 || after == times.size() || passage == Passage::step) continue;
        const double h = times[key + 1] - times[key], s = (seconds - times[key]) / h;
        if (passage == Passage::linear) {
            v += s * (value_at(*this, key + 1, i) - v);
            continue;
        }
        const double s2 = s * s, s3 = s2 * s;
        v = (2 * s3 - 3 * s2 + 1) * v + (s3 - 2 * s2 + s) * h * tangent(*this, key, i) +
            (3 * s2 - 2 * s3) * value_at(*this, key + 1, i) + (s3 - s2) * h * tangent(*this, key + 1, i);
    }
}

float track_time(double seconds) {
    const auto nearest = static_cast<float>(seconds);
    return nearest > seconds ? std::nextafter(nearest, 0.0f) : nearest;
}

Track track_of(const Curve& curve, TrackTarget target, int index, double factor) {
    Track track;
    track.target = target;
    track.index = index;
    track.width = curve.width;
    const bool cubic = (curve.passage == Passage::smooth || curve.passage == Passage::ease) && curve.times.size() > 1;
    track.interpolation = cubic ? Interpolation::cubic_spline
                                : (curve.passage == Passage::step ? Interpolation::step : Interpolation::linear);
    for (std::size_t k = 0; k < curve.times.size(); ++k) {
        track.times.push_back(track_time(curve.times[k]));
        const auto put = [&](auto&& number) {
            for (int i = 0; i < curve.width; ++i) track.values.push_back(static_cast<float>(factor * number(i)));
        };
        if (cubic) put([&](int i) { return tangent(curve, k, i); });
        put([&](int i) { return value_at(curve, k, i); });
        if (cubic) put([&](int i) { return tangent(curve, k, i); });
    }
    return track;
}

glm::dquat rotation_of(glm::dvec3 degrees) {
    const glm::dvec3 r = glm::radians(degrees);
    return glm::angleAxis(r.y, glm::dvec3(0, 1, 0)) * glm::angleAxis(r.x, glm::dvec3(1, 0, 0)) *
           glm::angleAxis(r.z, glm::dvec3(0, 0, 1));
}

Track rotation_track(const std::function<glm::dquat(double)>& rotation_at, std::vector<double> times, int node) {
    EXPECTS(!times.empty());
    std::vector<std::pair<double, glm::dquat>> keys;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const glm::dquat q = rotation_at(times[i]);
        // 2^14 keys between two of the file's: more would only serve motion faster than any picture shows.
        if (i > 0) densify(rotation_at, times[i - 1], keys.back().second, times[i], q, 14, keys);
        keys.emplace_back(times[i], q);
    }
    Track track;
    track.target = TrackTarget::rotation;
    track.index = node;
    track.width = 4;
    for (const auto& [time, q] : keys) {
        if (!track.times.empty() && !(track_time(time) > track.times.back())) continue;
        track.times.push_back(track_time(time));
        for (const double v : {q.x, q.y, q.z, q.w}) track.values.push_back(static_cast<float>(v));
    }
    return track;
}

}  // namespace render2mpeg::scene
