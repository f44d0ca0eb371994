#include "scene/animation_file/movement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "scene/animation_file/keys.h"
#include "scene/model/node.h"

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

void add_key(Track& track, double time, const glm::dquat& q) {
    track.times.push_back(track_time(time));
    for (const double v : {q.x, q.y, q.z, q.w}) track.values.push_back(static_cast<float>(v));
}

constexpr std::array<std::string_view, 4> passages{"smooth", "ease", "linear", "step"};

/// A list of numbers, one number for all three where that is plain, or a truth.
std::vector<double> read_value(const JsonValue& value, const Quantity& q) {
    if (q.steps) return {value.boolean() ? 1.0 : 0.0};
    if (q.width == 1) return {value.number(q.at_least, q.at_most)};
    if (value.is_number() && q.name == "rotate") return {0, value.number(q.at_least, q.at_most), 0};
    if (value.is_number() && q.name == "scale") return std::vector<double>(3, value.number(q.at_least, q.at_most));
    std::vector<double> out;
    for (const JsonValue& item : value.list(3, 3)) out.push_back(item.number(q.at_least, q.at_most));
    return out;
}

/// A quantity where a thing, or one of its keys, says it.
std::optional<JsonValue> said(const JsonValue& where, const Quantity& q) {
    if (q.reflection < 0) return where.find(q.name);
    const auto list = where.find("reflections");
    const std::vector<JsonValue> all = list ? list->list(0, most_reflections) : std::vector<JsonValue>{};
    const auto k = static_cast<std::size_t>(q.reflection);
    return k < all.size() ? all[k].find(q.name) : std::nullopt;
}

/// Repeats a curve's keys until the film ends.
void loop(Curve& curve, const Quantity& q, const JsonValue& where, const FilmClock& clock) {
    if (curve.times.size() < 2) return;
    if (clock.end <= 0) where.fail("repeats until the film ends; say `frames` or `seconds`");
    const std::size_t round = curve.times.size(), width = static_cast<std::size_t>(curve.width);
    const double period = curve.times.back() - curve.times.front();
    if (clock.end / period > 1e5)
        where.fail("has a round of " + std::to_string(period) + " s, too short to be repeated until the film ends");
    std::vector<double> offset(width, 0.0);
    for (int n = 1; curve.times.back() < clock.end; ++n) {
        for (std::size_t i = 0; i < width && q.accumulates; ++i)
            offset[i] += curve.values[(round - 1) * width + i] - curve.values[i];
        // A round's first key is the last of the round before.
        for (std::size_t k = 1; k < round; ++k) {
            std::vector<double> value(width);
            for (std::size_t i = 0; i < width; ++i) value[i] = curve.values[k * width + i] + offset[i];
            curve.add(curve.times[k] + n * period, value);
        }
    }
}

bool knows(std::span<const std::string_view> names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

void drop_tracks(Animation& film, int node, TrackTarget target) {
    std::erase_if(film.tracks, [&](const Track& t) { return t.index == node && t.target == target; });
}

std::array<double, 3> sampled(const Curve& curve, double seconds) {
    std::array<double, 3> v{};
    if (!curve.empty()) curve.sample(seconds, v);
    return v;
}

void turn(Animation& film, int node, const JsonValue& thing, const FilmClock& clock,
          std::span<const std::string_view> names, const Curve& position) {
    const Curve rotate = curve_of(thing, {"rotate", 3, -1e5, 1e5, false, true}, clock, names);
    const Curve look_at =
        knows(names, "look_at") ? curve_of(thing, {"look_at", 3, -1e7, 1e7, false, true}, clock, names) : Curve{};
    const Curve roll =
        knows(names, "roll") ? curve_of(thing, {"roll", 1, -1e5, 1e5, false, true}, clock, names) : Curve{};
    if (rotate.empty() && look_at.empty() && roll.empty()) return;
    if (!rotate.empty() && !look_at.empty())
        thing.fail("has both `rotate` and `look_at`; one of them says where it looks");

    // Rolling turns clockwise about the axis of sight, so that the horizon tilts the other way.
    const auto rotation_at = [&](double seconds) {
        const auto p = sampled(position, seconds), l = sampled(look_at, seconds), r = sampled(rotate, seconds);
        const glm::dquat axis_turn = glm::angleAxis(glm::radians(-sampled(roll, seconds)[0]), glm::dvec3(0, 0, 1));
        if (look_at.empty()) return rotation_of({r[0], r[1], r[2]}) * axis_turn;
        return turn_towards(glm::dvec3(l[0] - p[0], l[1] - p[1], l[2] - p[2]), glm::dvec3(0, 1, 0)) * axis_turn;
    };
    std::vector<double> times;
    for (const Curve* c : {&rotate, &look_at, &roll, &position}) {
        if (c == &position && look_at.empty()) continue;
        if (c->times.size() > 1) times.insert(times.end(), c->times.begin(), c->times.end());
    }
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());

    drop_tracks(film, node, TrackTarget::rotation);
    Node& turned = film.nodes[static_cast<std::size_t>(node)];
    turned.rotation = rotation_at(times.empty() ? 0 : times.front());
    if (times.empty()) return;
    Track track = rotation_track(rotation_at, times, node);
    const auto passage = [&](const Curve& c) { return c.times.size() < 2 || c.passage == Passage::step; };
    if (passage(rotate) && passage(look_at) && passage(roll) && (look_at.empty() || passage(position))) {
        // Everything jumps: a track of the keys themselves.
        track.times.clear();
        track.values.clear();
        track.interpolation = Interpolation::step;
        for (const double t : times) add_key(track, t, rotation_at(t));
    }
    film.tracks.push_back(std::move(track));
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
        add_key(track, time, q);
    }
    return track;
}

double FilmClock::seconds(const JsonValue& time) const {
    const double t = time.number(0, 1e7);
    return in_frames ? t / rate : t;
}

Curve curve_of(const JsonValue& thing, const Quantity& q, const FilmClock& clock,
               std::span<const std::string_view> key_names) {
    Curve curve;
    curve.width = q.width;
    curve.monotone = q.monotone;
    if (const auto word = thing.find("interpolation")) curve.passage = static_cast<Passage>(word->word(passages));
    if (q.steps) curve.passage = Passage::step;

    const auto constant = said(thing, q);
    const auto keys = thing.find("keys");
    double last = -1;
    for (const JsonValue& key : keys ? keys->list(1, most_keys) : std::vector<JsonValue>{}) {
        key.allow_only(key_names);
        const JsonValue at = key.need("at");
        const double seconds = clock.seconds(at);
        if (seconds <= last) at.fail("must be later than the key before");
        last = seconds;
        const auto value = said(key, q);
        if (!value) continue;
        if (constant)
            constant->fail("is said twice: here and in " + std::string(q.name == "look_at" ? "the" : "its") + " keys");
        curve.add(seconds, read_value(*value, q));
    }
    if (constant) curve.add(0, read_value(*constant, q));
    const auto loops = thing.find("loop");
    if (loops && loops->boolean()) loop(curve, q, *loops, clock);
    return curve;
}

int add_node(Animation& film, const std::string& name, int parent) {
    Node node;
    node.name = name;
    node.parent = parent;
    film.nodes.push_back(std::move(node));
    return static_cast<int>(film.nodes.size()) - 1;
}

void add_object(Animation& film, const std::string& name, int node, int mesh, int material) {
    Object object;
    object.name = name;
    object.node = node;
    object.mesh = mesh;
    object.material = material;
    film.objects.push_back(std::move(object));
}

void place(Animation& film, int node, const JsonValue& thing, const FilmClock& clock,
           std::span<const std::string_view> names) {
    const Curve position = curve_of(thing, {"position", 3, -1e7, 1e7, false, true}, clock, names);
    const auto apply = [&](const Curve& curve, TrackTarget target, auto&& set) {
        if (curve.empty()) return;
        separate(film.nodes[static_cast<std::size_t>(node)]);
        drop_tracks(film, node, target);
        set(film.nodes[static_cast<std::size_t>(node)], sampled(curve, curve.times.front()));
        if (curve.times.size() > 1) film.tracks.push_back(track_of(curve, target, node));
    };
    apply(position, TrackTarget::translation, [](Node& n, const auto& v) { n.translation = {v[0], v[1], v[2]}; });
    turn(film, node, thing, clock, names, position);
    if (knows(names, "scale"))
        apply(curve_of(thing, {"scale", 3, -1e6, 1e6, true}, clock, names), TrackTarget::scale,
              [](Node& n, const auto& v) {
                  n.scale = {v[0], v[1], v[2]};
              });
    if (!knows(names, "visible")) return;

    // Nodes have no visibility: a constant is a track of one key.
    const Curve visible = curve_of(thing, {"visible", 1, 0, 1, false, false, true}, clock, names);
    if (visible.empty()) return;
    drop_tracks(film, node, TrackTarget::visibility);
    film.tracks.push_back(track_of(visible, TrackTarget::visibility, node));
}

std::vector<int> copies_of(const JsonValue& thing, int placed, Animation& film) {
    const auto repeat = thing.find("repeat");
    if (!repeat) return {placed};
    repeat->allow_only(animation_file_keys::repeat);
    const std::string name = film.nodes[static_cast<std::size_t>(placed)].name;
    std::vector<int> copies;
    const auto add = [&]() -> Node& {
        copies.push_back(add_node(film, name + " " + std::to_string(copies.size() + 1), placed));
        return film.nodes.back();
    };
    if (const auto ring = repeat->find("ring")) {
        ring->allow_only(animation_file_keys::ring);
        const auto count = ring->need("count").integer(1, 100000);
        const double radius = ring->need("radius").number(0, 1e6);
        const double from = ring->number_or("from", -1e4, 1e4, 0);
        // A full turn's last copy lies one step before its end.
        const bool full = !ring->has("to");
        const double to = full ? from + 360 : ring->need("to").number(-1e4, 1e4);
        const double steps = full ? static_cast<double>(count) : std::max(1.0, static_cast<double>(count - 1));
        for (std::int64_t i = 0; i < count; ++i) {
            Node& copy = add();
            copy.rotation = rotation_of({0, from + (to - from) * static_cast<double>(i) / steps, 0});
            copy.translation = copy.rotation * glm::dvec3(0, 0, radius);
        }
        return copies;
    }
    std::int64_t count[3], total = 1;
    const std::vector<JsonValue> counts = repeat->need("count").list(3, 3);
    for (std::size_t k = 0; k < 3; ++k) total *= count[k] = counts[k].integer(1, 10000);
    if (total > 100000) repeat->need("count").fail("asks for " + std::to_string(total) + " copies; 100000 is the most");
    const glm::dvec3 step = repeat->need("step").position();
    const auto centered = repeat->find("centered");
    const double shift = centered && centered->boolean() ? 0.5 : 0;
    const auto along = [&](std::int64_t i, int axis) {
        return static_cast<double>(i) - shift * static_cast<double>(count[axis] - 1);
    };
    for (std::int64_t i = 0; i < total; ++i)
        add().translation = step * glm::dvec3(along(i % count[0], 0), along(i / count[0] % count[1], 1),
                                              along(i / count[0] / count[1], 2));
    return copies;
}

}  // namespace render2mpeg::scene
