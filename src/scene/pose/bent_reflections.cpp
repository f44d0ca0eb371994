#include "scene/pose/bent_reflections.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <utility>

#include "scene/pose/mirror_shape.h"
#include "scene/pose/pose.h"
#include "scene/pose/posing.h"
#include "scene/pose/snapshot.h"
#include "scene/pose/sweep.h"

namespace render2mpeg::scene {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// No bent ray leaves a surface at less than this sine. chosen: 3 degrees, by which triangles of a round body lie off
/// it; at 1e-3 rays along it meet its own triangles in a pattern.
constexpr double least_cosine = 0.05;

/// A point that is seen edge-on mirrors what lies behind it: its edit fades below this cosine. chosen: 6 degrees, some
/// frames of a turning mirror; tried 1 to 10.
constexpr double edge_on = 0.1;

/// A target nearer to its point than this share of the radius, and of the way to the eye, has no steady direction.
/// chosen: a hundredth.
constexpr double too_near = 0.01;

/// Width of a border over the way by which its picture is moved. chosen: 2.2, as a smooth step is 1.5 times as steep as
/// a straight one, and surfaces that curve need room; tried 1.6 (every edit reaches everywhere) to 3.2.
constexpr double border_of_way = 2.2;

/// Least share that is left in a border of the area that mirrored rays sweep. chosen: 0.15 on a plane, a sphere and a
/// cylinder, judged on an ellipsoid (test).
constexpr double least_area = 0.15;

/// Share of the area that rays sweep at the edit's point, below which a mirror folds its picture by itself. chosen: a
/// tenth; tried 0 (every dent of a body has an edit reach everywhere) to 0.3.
constexpr double folded_share = 0.1;

double smooth_step(double x) {
    const double u = std::clamp(x, 0.0, 1.0);
    return u * u * (3 - 2 * u);
}

/// A direction, kept so far above a surface.
glm::dvec3 lifted(glm::dvec3 v, glm::dvec3 normal, double least) {
    const double cosine = glm::dot(v, normal);
    if (cosine >= least) return v;
    const glm::dvec3 up = v + (least - cosine) * normal;
    const double length = glm::length(up);
    return length > 0 ? up / length : normal;
}

glm::dvec3 rotated(glm::dvec3 v, glm::dvec3 turn) {
    const double angle = glm::length(turn);
    if (!(angle > 0)) return v;
    const glm::dvec3 axis = turn / angle;
    return std::cos(angle) * v + std::sin(angle) * glm::cross(axis, v) +
           (1 - std::cos(angle)) * glm::dot(axis, v) * axis;
}

/// The turn of mirrored rays at one place by several edits.
class MixedTurn {
  public:
    void add(const Bend& bend, glm::dvec3 place) {
        if (!(bend.strength > 0)) return;
        const double distance = glm::length(place - bend.at);
        const double falloff = 1 - smooth_step((distance - bend.radius) * bend.fade);
        const double share = bend.strength * (bend.everywhere + (1 - bend.everywhere) * falloff);
        if (!(share > 0)) return;
        // [Ritschel2009b, eq. 7.3]: at its own point an edit outweighs all others.
        const double nearest = 1e-9 * bend.radius, weight = share / (distance * distance + nearest * nearest);
        turn_ += weight * bend.turn;
        sum_ += weight;
        untouched_ *= 1 - share;
    }
    bool any() const { return sum_ > 0; }
    glm::dvec3 turn() const { return any() ? (1 - untouched_) / sum_ * turn_ : glm::dvec3(0); }

  private:
    glm::dvec3 turn_{0};
    double sum_ = 0, untouched_ = 1;
};

/// How far over the mirror the picture is moved that a turn brings to its point: where the mirror shows it by itself,
/// as if it curved evenly. Infinite where it never does.
struct Way {
    double length = infinite;
    double swept = 0;  ///< area that mirrored rays sweep over that of the mirror
};
Way way_of_turn(const LocalMirror& mirror, glm::dvec3 to_spot, glm::dvec3 r, glm::dvec3 turn) {
    const Spot& spot = mirror.spot;
    const double distance = glm::length(to_spot), angle = glm::length(turn), step = 1e-4 * distance;
    const glm::dvec3 moved = glm::cross(turn, r);
    const glm::dvec3 dx = (mirror.ray({step, 0}).mirrored - mirror.ray({-step, 0}).mirrored) / (2 * step),
                     dy = (mirror.ray({0, step}).mirrored - mirror.ray({0, -step}).mirrored) / (2 * step);
    const double aa = glm::dot(dx, dx), ab = glm::dot(dx, dy), bb = glm::dot(dy, dy), area = aa * bb - ab * ab;
    // Treat rays as parallel if they differ by a millionth of the difference of others.
    if (!(area > 1e-12 * (aa + bb) * (aa + bb))) return {};
    const double ma = glm::dot(moved, dx), mb = glm::dot(moved, dy);
    const glm::dvec3 way = ((bb * ma - ab * mb) * spot.along[0] + (aa * mb - ab * ma) * spot.along[1]) / area;
    const double first = glm::length(way);
    if (!mirror.now.has_eye || !(first > 0)) return {first, std::sqrt(area)};
    // Of the rate at which rays turn on that way, the part that a flat mirror has falls with the distance from the
    // eye: the law of sines in the triangle of eye, point and place.
    const glm::dvec3 along = way / first, i = to_spot / distance;
    const double sine = glm::length(glm::cross(along, i)), cosine = glm::dot(along, i);
    const double beyond = std::max(sine * std::cos(angle) - cosine * std::sin(angle), 0.0);
    const double rate = angle / first - sine / distance + angle * beyond / (distance * std::sin(angle));
    return {rate > 0 ? angle / rate : infinite, std::sqrt(area)};
}

/// Three neighbouring places of a mirror, and the rays that it sends from there by itself.
struct Cell {
    glm::dvec3 place[3], mirrored[3];
    double weight;  ///< 0..1: less where it is seen edge-on
};

double area_of(const glm::dvec3 (&ray)[3]) {
    return glm::dot(glm::cross(ray[1] - ray[0], ray[2] - ray[0]), ray[0]);
}

/// `usual`: area that rays sweep over that of the mirror, at edits' points. Where there is far less the mirror turns
/// from hollow to bulging, and its picture folds by itself.
void add_cell(const glm::dvec3 (&place)[3], const MirroredRay (&ray)[3], double usual, std::vector<Cell>& cells) {
    Cell cell;
    for (int k = 0; k < 3; ++k) {
        cell.place[k] = place[k];
        cell.mirrored[k] = ray[k].mirrored;
    }
    const double cosine = std::min({ray[0].cosine, ray[1].cosine, ray[2].cosine});
    const double swept =
        std::abs(area_of(cell.mirrored)) / glm::length(glm::cross(place[1] - place[0], place[2] - place[0]));
    cell.weight = smooth_step(cosine / edge_on - 0.5) * smooth_step(swept / (folded_share * usual));
    if (cell.weight > 0) cells.push_back(cell);
}

/// Cells in the border of a bend, as the mirror curves at its point: what flat mirrors have is between few corners.
void add_near_cells(const LocalMirror& mirror, const Bend& bend, double usual, std::vector<Cell>& cells) {
    constexpr int rings = 12, spokes = 24;
    const double curved = std::max(glm::length(mirror.spot.turn[0]), glm::length(mirror.spot.turn[1]));
    const double reach = std::min(bend.radius + 1 / bend.fade,
                                  curved > 0 ? 0.5 / curved : std::numeric_limits<double>::infinity()),
                 step = 1e-3 * reach;
    for (int ring = 1; ring <= rings; ++ring)
        for (int spoke = 0; spoke < spokes; ++spoke) {
            const double angle = 2 * glm::pi<double>() * spoke / spokes;
            const glm::dvec2 x = ring * reach / rings * glm::dvec2(std::cos(angle), std::sin(angle)),
                             around[3] = {x, x + glm::dvec2(step, 0), x + glm::dvec2(0, step)};
            glm::dvec3 place[3];
            MirroredRay ray[3];
            for (int k = 0; k < 3; ++k) {
                place[k] = mirror.place(around[k]);
                ray[k] = mirror.ray(around[k]);
            }
            add_cell(place, ray, usual, cells);
        }
}

/// Triangles of a mirror's meshes, so many at most.
void add_mesh_cells(const Animation& animation, int node, const Instant& now, double side, double usual,
                    std::vector<Cell>& cells) {
    constexpr std::size_t most = 6000;
    for (std::uint32_t o = 0; o < animation.objects.size(); ++o) {
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(animation.objects[o].mesh)];
        const ObjectState& state = now.objects[o];
        if (animation.objects[o].node != node || !state.present || mesh.normals.empty()) continue;
        for (std::size_t t = 0; t < mesh.triangles.size(); t += mesh.triangles.size() / most + 1) {
            const Corners c = corners_of(animation, o, static_cast<std::uint32_t>(t), state, now.deformed);
            MirroredRay ray[3];
            for (int k = 0; k < 3; ++k) ray[k] = ray_at(now, c.place[k], side * c.normal[k]);
            add_cell(c.place, ray, usual, cells);
        }
    }
}

/// The smallest share of their turns that edits of a mirror must have everywhere, so that its picture folds in no cell:
/// there the area that rays sweep would change its sign. What folds even so is left.
double share_everywhere(std::vector<Cell> cells, std::vector<Bend> bends) {
    const auto folds_in = [&](const Cell& cell) {
        glm::dvec3 ray[3];
        for (int k = 0; k < 3; ++k) {
            MixedTurn mixed;
            for (const Bend& bend : bends) mixed.add(bend, cell.place[k]);
            ray[k] = rotated(cell.mirrored[k], mixed.turn());
        }
        return 1 + cell.weight * (area_of(ray) / area_of(cell.mirrored) - 1) < least_area;
    };
    const auto folds = [&](double everywhere) {
        for (Bend& bend : bends) bend.everywhere = everywhere;
        return std::any_of(cells.begin(), cells.end(), folds_in);
    };
    if (!folds(0)) return 0;
    if (folds(1)) std::erase_if(cells, folds_in);
    double low = 0, high = 1;
    for (int k = 0; k < 10; ++k) {
        const double middle = 0.5 * (low + high);
        (folds(middle) ? low : high) = middle;
    }
    return high;
}

/// One edit at one instant; of no strength where it cannot be. Adds the cells about its point, and what is `usual`
/// there.
Bend bend_at(const Reflection& edit, std::size_t index, const std::optional<AimedPoint>& aimed, bool back,
             const Animation& animation, const Instant& now, double& usual, std::vector<Cell>& cells) {
    Bend bend;
    if (!aimed) return bend;
    const auto spot = spot_at(animation, aimed->address, now.objects[aimed->address.object], now.deformed);
    if (!spot) return bend;
    const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(now.pose.world_of(edit.mirror)))));
    bend.at = spot->place;
    bend.radius = scale * static_cast<double>(now.pose.reflection_radius[index]);
    const double border = scale * static_cast<double>(now.pose.reflection_border[index]);
    const glm::dvec3 to_spot = now.way_to(spot->place), n = back ? -spot->normal : spot->normal;
    const double distance = glm::length(to_spot);
    const glm::dvec3 seen = glm::dvec3(now.pose.world_of(edit.see)[3]) - animation.origin - spot->place;
    const double far = glm::length(seen), cosine = -glm::dot(to_spot, n) / distance;
    // The comparisons are false for non-finite values.
    if (!(distance > 0) || !(far > 0) || !(bend.radius > 0) || !(border > 0) || !std::isfinite(far + distance + border))
        return bend;
    bend.strength = smooth_step(cosine / edge_on) *
                    smooth_step(far / (too_near * std::min(bend.radius, now.has_eye ? distance : infinite)));
    if (!(bend.strength > 0)) return bend;

    const glm::dvec3 r = to_spot / distance + 2 * cosine * n, e = lifted(seen / far, n, least_cosine);
    const glm::dvec3 axis = glm::cross(r, e);
    const double sine = glm::length(axis);
    bend.fade = 1 / border;
    if (!(sine > 1e-9)) return bend;  // it shows its target by itself
    bend.turn = std::atan2(sine, glm::dot(r, e)) / sine * axis;

    const LocalMirror mirror{*spot, now, back ? -1.0 : 1.0};
    const Way way = way_of_turn(mirror, to_spot, r, bend.turn);
    bend.fade = 1 / std::max(border, border_of_way * way.length);
    if (!(bend.fade > 0)) return bend;
    add_near_cells(mirror, bend, way.swept, cells);
    usual = std::min(usual, way.swept);
    return bend;
}

/// All edits at one instant. What no border can take without a fold, the whole mirror turns.
std::vector<Bend> bends_at(const Animation& animation, const std::vector<std::optional<AimedPoint>>& aimed,
                           const std::vector<bool>& back, const Instant& now) {
    const std::vector<Reflection>& edits = animation.reflections;
    std::vector<Bend> bends(edits.size());
    std::vector<bool> done(edits.size(), false);
    for (std::size_t first = 0; first < edits.size(); ++first) {
        if (done[first]) continue;
        std::vector<Cell> cells;
        std::vector<Bend> together;
        double usual = infinite;
        const auto goes_along = [&](std::size_t k) {
            return edits[k].mirror == edits[first].mirror && back[k] == back[first];
        };
        for (std::size_t k = first; k < edits.size(); ++k)
            if (goes_along(k)) {
                bends[k] = bend_at(edits[k], k, aimed[k], back[k], animation, now, usual, cells);
                together.push_back(bends[k]);
            }
        if (std::isfinite(usual))
            add_mesh_cells(animation, edits[first].mirror, now, back[first] ? -1 : 1, usual, cells);
        const double everywhere = share_everywhere(std::move(cells), std::move(together));
        for (std::size_t k = first; k < edits.size(); ++k)
            if (goes_along(k)) {
                bends[k].everywhere = everywhere;
                done[k] = true;
            }
    }
    return bends;
}

Instant middle_instant(const Snapshot& s, const Pose& pose) {
    return {s.objects,         s.deformed, pose, glm::dvec3(s.camera.position()), glm::dvec3(s.camera.forward()),
            s.camera.has_eye()};
}

}  // namespace

std::optional<AimedPoint> aimed_point(const Reflection& edit, const Snapshot& snapshot, const Pose& pose) {
    const Animation& animation = *snapshot.animation;
    const glm::dvec3 wanted = glm::dvec3(pose.world_of(edit.at)[3]) - animation.origin;
    std::optional<AimedPoint> best;
    for (std::uint32_t o = 0; o < animation.objects.size(); ++o) {
        const ObjectState& state = snapshot.objects[o];
        if (animation.objects[o].node != edit.mirror || !state.present) continue;
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(animation.objects[o].mesh)];
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const Corners c = corners_of(animation, o, t, state, snapshot.deformed);
            const glm::dvec2 w = nearest_weights(wanted, c.place);
            const glm::dvec3 place = (1 - w.x - w.y) * c.place[0] + w.x * c.place[1] + w.y * c.place[2];
            const double off = glm::length(place - wanted);
            if (best ? off < best->off : std::isfinite(off))
                best = {{o, t, static_cast<float>(w.x), static_cast<float>(w.y)}, place, off};
        }
    }
    return best;
}

std::shared_ptr<const BentReflections> bend_reflections(const Snapshot& snapshot, const Pose& pose, int camera,
                                                        const ShutterInterval& shutter) {
    const Animation& animation = *snapshot.animation;
    const std::vector<Reflection>& edits = animation.reflections;
    if (edits.empty()) return nullptr;
    auto all = std::make_shared<BentReflections>();
    all->of_object_.resize(animation.objects.size());
    std::vector<std::optional<AimedPoint>> aimed;
    const Instant middle = middle_instant(snapshot, pose);
    for (std::size_t k = 0; k < edits.size(); ++k) {
        aimed.push_back(aimed_point(edits[k], snapshot, pose));
        for (std::size_t o = 0; o < animation.objects.size(); ++o)
            if (animation.objects[o].node == edits[k].mirror) all->of_object_[o].push_back(k);
        std::optional<Spot> spot;
        if (aimed[k])
            spot = spot_at(animation, aimed[k]->address, snapshot.objects[aimed[k]->address.object], snapshot.deformed);
        all->back_.push_back(spot && glm::dot(spot->front, middle.way_to(spot->place)) > 0);
    }
    const auto pose_all = [&](const Instant& now) {
        all->knots_.push_back(bends_at(animation, aimed, all->back_, now));
    };
    if (!shutter.is_open() || !snapshot.sweep) {
        pose_all(middle);
        return all;
    }
    const CameraPath path(animation, camera);
    const double time = snapshot.time.value(), steps = time + shutter.middle();
    for (const int k : {0, 1, 2}) {
        if (k == 1) {
            pose_all(middle);
            continue;
        }
        const double seconds = time + (k == 0 ? shutter.opens : shutter.closes);
        const Pose there = pose_at(animation, seconds, steps);
        const Camera eye = snapshot.camera.moved(rigid(path.to_world(seconds, steps), animation.origin),
                                                 snapshot.camera.lens().vertical_fov);
        const std::vector<SweepKnot>& knots = snapshot.sweep->knots;
        const SweepKnot* knot = knots.empty() ? nullptr : k == 0 ? &knots.front() : &knots.back();
        pose_all({knot ? knot->objects : snapshot.objects, knot ? knot->deformed : snapshot.deformed, there,
                  glm::dvec3(eye.position()), glm::dvec3(eye.forward()), snapshot.camera.has_eye()});
    }
    return all;
}

Bend BentReflections::at(std::size_t edit, float time) const {
    if (knots_.size() == 1 || time == middle_time) return middle()[edit];
    const SweepPlace place(2, time);
    const Bend &a = knots_[place.knot][edit], &b = knots_[place.knot + 1][edit];
    const double t = static_cast<double>(place.share);
    return {glm::mix(a.at, b.at, t),
            glm::mix(a.turn, b.turn, t),
            glm::mix(a.radius, b.radius, t),
            glm::mix(a.fade, b.fade, t),
            glm::mix(a.everywhere, b.everywhere, t),
            glm::mix(a.strength, b.strength, t)};
}

glm::dvec3 BentReflections::bent(std::uint32_t object, bool back_side, glm::dvec3 place, glm::dvec3 normal,
                                 glm::dvec3 mirrored, float time) const {
    MixedTurn mixed;
    for (const std::size_t edit : of_object_[object])
        if (back_[edit] == back_side) mixed.add(at(edit, time), place);
    if (!mixed.any()) return mirrored;
    return lifted(rotated(mirrored, mixed.turn()), normal, std::clamp(glm::dot(mirrored, normal), 0.0, least_cosine));
}

std::optional<glm::dvec3> shown_at(glm::dvec3 point, const core::SurfaceAddress& near, const Snapshot& world) {
    const ObjectState& state = world.objects[near.object];
    if (!state.present) return std::nullopt;
    const std::optional<Spot> spot = spot_at(*world.animation, near, state, world.deformed);
    if (!spot) return std::nullopt;
    const Pose nowhere;
    const Instant now = middle_instant(world, nowhere);
    const bool back = glm::dot(spot->front, now.way_to(spot->place)) > 0;
    const LocalMirror mirror{*spot, now, back ? -1.0 : 1.0};

    // How far the ray from a place that lies x along the surface misses the point.
    const auto miss = [&](glm::dvec2 x) {
        const glm::dvec3 q = mirror.place(x);
        return world.bends->bent(near.object, back, q, mirror.normal(x), mirror.ray(x).mirrored, middle_time) -
               glm::normalize(point - q);
    };
    // Newton's method, with differences for derivatives, least squares for the three components.
    glm::dvec2 x(0);
    const double step = 1e-5 * glm::length(now.way_to(spot->place));
    for (int round = 0; round < 12; ++round) {
        const glm::dvec3 off = miss(x), dx = (miss(x + glm::dvec2(step, 0)) - off) / step,
                         dy = (miss(x + glm::dvec2(0, step)) - off) / step;
        if (!(glm::length(off) < 2)) return std::nullopt;
        if (glm::length(off) < 1e-9) return mirror.place(x);
        const double aa = glm::dot(dx, dx), ab = glm::dot(dx, dy), bb = glm::dot(dy, dy), area = aa * bb - ab * ab;
        if (!(area > 0)) return std::nullopt;
        const double ma = glm::dot(off, dx), mb = glm::dot(off, dy);
        x -= glm::dvec2(bb * ma - ab * mb, aa * mb - ab * ma) / area;
    }
    return glm::length(miss(x)) < 1e-6 ? std::optional(mirror.place(x)) : std::nullopt;
}

}  // namespace render2mpeg::scene
