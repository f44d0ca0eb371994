#include "scene/pose/bent_reflections.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "scene/pose/pose.h"
#include "scene/pose/posing.h"

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

/// Objects and eye at one instant.
struct Instant {
    const std::vector<ObjectState>& objects;
    const std::vector<DeformedMesh>& deformed;
    const Pose& pose;
    glm::dvec3 eye, forward;
    bool perspective;

    /// From the eye to a place.
    glm::dvec3 way_to(glm::dvec3 place) const { return perspective ? place - eye : forward; }
};

/// A place of a surface and how it curves there.
struct Spot {
    glm::dvec3 place{0}, front{0}, normal{0};  ///< `front`: the triangle's own normal, `normal` the smooth one
    glm::dvec3 along[2]{},
        turn[2]{glm::dvec3(0), glm::dvec3(0)};  ///< two unit directions, and how the normal turns on the way along each
};

struct Corners {
    glm::dvec3 place[3], normal[3];
};

/// Corners of a triangle; normals are 0 where the mesh has none.
Corners corners_of(const Animation& animation, std::uint32_t object, std::uint32_t primitive, const ObjectState& state,
                   const std::vector<DeformedMesh>& deformed) {
    const Mesh& mesh = animation.meshes[static_cast<std::size_t>(animation.objects[object].mesh)];
    Corners out;
    for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.triangles[primitive][k];
        if (state.deformed >= 0) {
            const DeformedMesh& bent = deformed[static_cast<std::size_t>(state.deformed)];
            out.place[k] = bent.positions[v];
            out.normal[k] = bent.normals.empty() ? glm::dvec3(0) : glm::dvec3(bent.normals[v]);
            continue;
        }
        out.place[k] = glm::dmat4(state.to_world) * glm::dvec4(mesh.positions[v], 1);
        out.normal[k] = mesh.normals.empty() ? glm::dvec3(0) : glm::dvec3(state.normal_to_world * mesh.normals[v]);
        if (const double length = glm::length(out.normal[k]); length > 0) out.normal[k] /= length;
    }
    return out;
}

/// None where the triangle has no area.
std::optional<Spot> spot_at(const Animation& animation, const core::SurfaceAddress& a, const ObjectState& state,
                            const std::vector<DeformedMesh>& deformed) {
    const Corners c = corners_of(animation, a.object, a.primitive, state, deformed);
    const double u = static_cast<double>(a.u), v = static_cast<double>(a.v);
    const glm::dvec3 e1 = c.place[1] - c.place[0], e2 = c.place[2] - c.place[0], across = glm::cross(e1, e2);
    const double area2 = glm::length(across);
    if (!(area2 > 0)) return std::nullopt;
    Spot spot;
    spot.place = c.place[0] + u * e1 + v * e2;
    const bool turned = state.deformed < 0 && glm::determinant(glm::dmat3(state.to_world)) < 0;
    spot.front = (turned ? -1.0 : 1.0) / area2 * across;
    spot.normal = (1 - u - v) * c.normal[0] + u * c.normal[1] + v * c.normal[2];
    const double length = glm::length(spot.normal);
    const bool flat = !(length > 0) || !(glm::dot(spot.normal, spot.front) > 0);
    spot.normal = flat ? spot.front : spot.normal / length;
    spot.along[0] = glm::normalize(e1);
    spot.along[1] = glm::cross(across / area2, spot.along[0]);
    for (int k = 0; k < 2; ++k) {
        if (flat) continue;
        const double by1 = glm::dot(glm::cross(spot.along[k], e2), across) / (area2 * area2),
                     by2 = glm::dot(glm::cross(e1, spot.along[k]), across) / (area2 * area2);
        spot.turn[k] = (by1 * (c.normal[1] - c.normal[0]) + by2 * (c.normal[2] - c.normal[0])) / length;
        spot.turn[k] -= glm::dot(spot.turn[k], spot.normal) * spot.normal;
    }
    return spot;
}

/// Weights of the second and the third corner at the point of a triangle that is nearest to p.
glm::dvec2 nearest_weights(glm::dvec3 p, const glm::dvec3 (&corner)[3]) {
    const glm::dvec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0], d = p - corner[0];
    const double aa = glm::dot(e1, e1), ab = glm::dot(e1, e2), bb = glm::dot(e2, e2), pa = glm::dot(d, e1),
                 pb = glm::dot(d, e2), area = aa * bb - ab * ab;
    const glm::dvec2 inside((bb * pa - ab * pb) / area, (aa * pb - ab * pa) / area);
    if (area > 0 && inside.x >= 0 && inside.y >= 0 && inside.x + inside.y <= 1) return inside;
    const auto share = [](double over, double whole) { return whole > 0 ? std::clamp(over / whole, 0.0, 1.0) : 0.0; };
    const double third = share(pb - ab - pa + aa, aa + bb - 2 * ab);
    const glm::dvec2 on_edges[3] = {{share(pa, aa), 0}, {0, share(pb, bb)}, {1 - third, third}};
    return *std::min_element(std::begin(on_edges), std::end(on_edges), [&](glm::dvec2 x, glm::dvec2 y) {
        return glm::length(x.x * e1 + x.y * e2 - d) < glm::length(y.x * e1 + y.y * e2 - d);
    });
}

/// A mirror about an edit's point as its first two derivatives have it, and what an eye sees in it.
struct LocalMirror {
    const Spot& spot;
    const Instant& now;
    double side;  ///< -1: it is seen from behind

    struct Ray {
        glm::dvec3 mirrored{0};
        double cosine = 0;  ///< to the normal
    };
    glm::dvec3 place(glm::dvec2 x) const {
        const glm::dvec3 over = x.x * spot.along[0] + x.y * spot.along[1];
        return spot.place + over - 0.5 * glm::dot(over, x.x * spot.turn[0] + x.y * spot.turn[1]) * spot.normal;
    }
    glm::dvec3 normal(glm::dvec2 x) const {
        return side * glm::normalize(spot.normal + x.x * spot.turn[0] + x.y * spot.turn[1]);
    }
    Ray ray(glm::dvec2 x) const { return ray_at(place(x), normal(x)); }
    Ray ray_at(glm::dvec3 place, glm::dvec3 n) const {
        const glm::dvec3 i = glm::normalize(now.way_to(place));
        return {i - 2 * glm::dot(i, n) * n, -glm::dot(i, n)};
    }
};

glm::dvec3 rotated(glm::dvec3 v, glm::dvec3 turn) {
    const double angle = glm::length(turn);
    if (!(angle > 0)) return v;
    const glm::dvec3 axis = turn / angle;
    return std::cos(angle) * v + std::sin(angle) * glm::cross(axis, v) +
           (1 - std::cos(angle)) * glm::dot(axis, v) * axis;
}

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
    // Rays that differ by a millionth of what others do are parallel.
    if (!(area > 1e-12 * (aa + bb) * (aa + bb))) return {};
    const double ma = glm::dot(moved, dx), mb = glm::dot(moved, dy);
    const glm::dvec3 way = ((bb * ma - ab * mb) * spot.along[0] + (aa * mb - ab * ma) * spot.along[1]) / area;
    const double first = glm::length(way);
    if (!mirror.now.perspective || !(first > 0)) return {first, std::sqrt(area)};
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
    double distance[3];  ///< from the edit's point
    glm::dvec3 mirrored[3];
    double weight;  ///< 0..1: less where it is seen edge-on
};

double area_of(const glm::dvec3 (&ray)[3]) {
    return glm::dot(glm::cross(ray[1] - ray[0], ray[2] - ray[0]), ray[0]);
}

/// `usual`: area that rays sweep over that of the mirror, at the edit's point. Where there is far less the mirror turns
/// from hollow to bulging, and its picture folds by itself.
void add_cell(const glm::dvec3 (&place)[3], const LocalMirror::Ray (&ray)[3], glm::dvec3 at, double usual,
              std::vector<Cell>& cells) {
    Cell cell;
    for (int k = 0; k < 3; ++k) {
        cell.distance[k] = glm::length(place[k] - at);
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
    const double reach = std::min(bend.radius + 1 / bend.fade, 0.5 / curved), step = 1e-3 * reach;
    for (int ring = 1; ring <= rings; ++ring)
        for (int spoke = 0; spoke < spokes; ++spoke) {
            const double angle = 2 * glm::pi<double>() * spoke / spokes;
            const glm::dvec2 x = ring * reach / rings * glm::dvec2(std::cos(angle), std::sin(angle)),
                             around[3] = {x, x + glm::dvec2(step, 0), x + glm::dvec2(0, step)};
            glm::dvec3 place[3];
            LocalMirror::Ray ray[3];
            for (int k = 0; k < 3; ++k) {
                place[k] = mirror.place(around[k]);
                ray[k] = mirror.ray(around[k]);
            }
            add_cell(place, ray, bend.at, usual, cells);
        }
}

/// Triangles of a mirror's meshes, so many at most.
void add_mesh_cells(const Animation& animation, int node, const LocalMirror& mirror, glm::dvec3 at, double usual,
                    std::vector<Cell>& cells) {
    constexpr std::size_t most = 6000;
    for (std::uint32_t o = 0; o < animation.objects.size(); ++o) {
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(animation.objects[o].mesh)];
        const ObjectState& state = mirror.now.objects[o];
        if (animation.objects[o].node != node || !state.present || mesh.normals.empty()) continue;
        for (std::size_t t = 0; t < mesh.triangles.size(); t += mesh.triangles.size() / most + 1) {
            const Corners c = corners_of(animation, o, static_cast<std::uint32_t>(t), state, mirror.now.deformed);
            LocalMirror::Ray ray[3];
            for (int k = 0; k < 3; ++k) ray[k] = mirror.ray_at(c.place[k], mirror.side * c.normal[k]);
            add_cell(c.place, ray, at, usual, cells);
        }
    }
}

/// The smallest share of a turn that the whole mirror must have so that its picture folds in no cell: there the area
/// that rays sweep would change its sign.
double share_everywhere(const std::vector<Cell>& cells, const Bend& bend) {
    const auto folds = [&](double everywhere) {
        return std::any_of(cells.begin(), cells.end(), [&](const Cell& cell) {
            glm::dvec3 ray[3];
            for (int k = 0; k < 3; ++k) {
                const double falloff = 1 - smooth_step((cell.distance[k] - bend.radius) * bend.fade);
                ray[k] = rotated(cell.mirrored[k], (everywhere + (1 - everywhere) * falloff) * bend.turn);
            }
            return 1 + cell.weight * (area_of(ray) / area_of(cell.mirrored) - 1) < least_area;
        });
    };
    if (!folds(0)) return 0;
    double low = 0, high = 1;
    for (int k = 0; k < 10; ++k) {
        const double middle = 0.5 * (low + high);
        (folds(middle) ? low : high) = middle;
    }
    return high;
}

/// One edit at one instant; of no strength where it cannot be.
Bend bend_at(const Reflection& edit, std::size_t index, const std::optional<AimedPoint>& aimed, bool back,
             const Animation& animation, const Instant& now) {
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
    // The comparisons are false for what is not finite.
    if (!(distance > 0) || !(far > 0) || !(bend.radius > 0) || !(border > 0) || !std::isfinite(far + distance + border))
        return bend;
    bend.strength = smooth_step(cosine / edge_on) *
                    smooth_step(far / (too_near * std::min(bend.radius, now.perspective ? distance : infinite)));
    if (!(bend.strength > 0)) return bend;

    const glm::dvec3 r = to_spot / distance + 2 * cosine * n, e = lifted(seen / far, n, least_cosine);
    const glm::dvec3 axis = glm::cross(r, e);
    const double sine = glm::length(axis);
    bend.fade = 1 / border;
    if (!(sine > 1e-9)) return bend;  // it shows its target by itself
    bend.turn = std::atan2(sine, glm::dot(r, e)) / sine * axis;

    // Give it a border that does not fold; what none can take, the whole mirror turns.
    const LocalMirror mirror{*spot, now, back ? -1.0 : 1.0};
    const Way way = way_of_turn(mirror, to_spot, r, bend.turn);
    bend.fade = 1 / std::max(border, border_of_way * way.length);
    if (!(bend.fade > 0)) return bend;
    std::vector<Cell> cells;
    add_near_cells(mirror, bend, way.swept, cells);
    add_mesh_cells(animation, edit.mirror, mirror, bend.at, way.swept, cells);
    bend.everywhere = share_everywhere(cells, bend);
    return bend;
}

Instant middle_instant(const Snapshot& s, const Pose& pose) {
    return {s.objects,
            s.deformed,
            pose,
            glm::dvec3(s.camera.position()),
            glm::dvec3(s.camera.forward()),
            s.camera.perspective()};
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
        std::vector<Bend>& knot = all->knots_.emplace_back();
        for (std::size_t k = 0; k < edits.size(); ++k)
            knot.push_back(bend_at(edits[k], k, aimed[k], all->back_[k], animation, now));
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
        const glm::dmat4 eye(rigid(path.to_world(seconds, steps), animation.origin));
        const std::vector<SweepKnot>& knots = snapshot.sweep->knots;
        const SweepKnot* knot = knots.empty() ? nullptr : k == 0 ? &knots.front() : &knots.back();
        pose_all({knot ? knot->objects : snapshot.objects, knot ? knot->deformed : snapshot.deformed, there,
                  glm::dvec3(eye[3]), -glm::dvec3(eye[2]), snapshot.camera.perspective()});
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
    glm::dvec3 turn(0);
    double sum = 0, untouched = 1;
    for (const std::size_t edit : of_object_[object]) {
        const Bend bend = at(edit, time);
        if (back_[edit] != back_side || !(bend.strength > 0)) continue;
        const double distance = glm::length(place - bend.at);
        const double falloff = 1 - smooth_step((distance - bend.radius) * bend.fade);
        const double share = bend.strength * (bend.everywhere + (1 - bend.everywhere) * falloff);
        if (!(share > 0)) continue;
        // [Ritschel2009b, eq. 7.3]: at its own point an edit outweighs all others.
        const double nearest = 1e-9 * bend.radius, weight = share / (distance * distance + nearest * nearest);
        turn += weight * bend.turn;
        sum += weight;
        untouched *= 1 - share;
    }
    if (!(sum > 0)) return mirrored;
    return lifted(rotated(mirrored, (1 - untouched) / sum * turn), normal,
                  std::clamp(glm::dot(mirrored, normal), 0.0, least_cosine));
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
