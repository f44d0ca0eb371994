// A camera for films that have none.
//
// An object is best seen from an orbit about it. A closed room shows an orbit nothing but the backs of its walls: there
// the camera turns about within; and a room with an open side, like a Cornell box, is best seen through it. The ways
// are told apart by what a view shows: cells of surface that face the eye, and such that are turned away
// (surface_grid.h). No scene needs to be recognised.
#include "scene/preparation/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/numeric.h"
#include "scene/pose/extent.h"
#include "scene/pose/pose.h"
#include "scene/pose/surface_grid.h"
#include "scene/preparation/default_light.h"

namespace render2mpeg::scene {
namespace {

constexpr double vertical_fov = 0.6981317;  // 40 degrees: tangent 0.364 of half of it, as in surface_grid.cpp
constexpr double orbit_elevation = 0.35;    // radians: shows tops as well as sides
constexpr double front_elevation = 0.03;    // nearly level, so that the ceiling of a box does not hide its back wall
constexpr int headings = 8;
// Shares of turned-away cells that an orbit sees. chosen: between those of objects, halls and rooms without outer walls
// (bench/tables/pictures.csv).
constexpr double share_of_halls = 0.12, share_of_one_sided = 0.5;
// chosen: 1.45 .. 1.8 choose alike (bench/tables/pictures.csv).
constexpr double gain_within = 1.6;
// chosen: cells of 216 rays that the emptiest heading sees in a room that is open above (30 to 80 choose alike).
constexpr double least_of_rooms = 40;
// chosen: a room is high and wide enough to stand in, in metres, and several things are in it; bowls are neither.
constexpr double least_height = 1.8, least_width = 2.0;
constexpr std::size_t least_things = 6;
// Of the radius that the middle 98 % of the triangles span. chosen: between scenes with a backdrop and without
// (bench/tables/pictures.csv); below 0.1 they are too few to span anything.
constexpr double least_trimmed = 0.1, most_trimmed = 0.5;
// chosen: a Cornell box has 0 seen through its open side, a closed room 0.8; 0.05 .. 0.5 choose alike.
constexpr double share_of_open_side = 0.2;
// A longer lens than elsewhere, as products are shown. chosen: 16 seconds a turn is slow enough to look at, 4 seconds
// of it show the front and both sides.
constexpr double studio_fov = 0.5235988;  // 30 degrees
constexpr double studio_start = 0.7;
constexpr double studio_period = 16, orbit_period = 8, turn_period = 16, sway_period = 8;  // seconds

constexpr const char* automatic_name = "automatic";

double heading_of(int k) {
    return 2 * glm::pi<double>() * k / headings;
}

/// Right, up and back of a camera that looks along -z, turned up by `pitch`, then to the left by `yaw`.
glm::dmat3 axes_for(double yaw, double pitch) {
    return glm::mat3_cast(glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0)));
}

/// How far from the centre of the extent a camera sees the whole of it from every heading, in a square picture at the
/// least.
double fitting_distance(const Extent& extent, double elevation) {
    const double tangent = std::tan(0.5 * vertical_fov);
    double distance = 0;
    for (int k = 0; k < headings; ++k) {
        const glm::dmat3 axes = axes_for(heading_of(k), -elevation);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 side(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
            const glm::dvec3 seen = glm::transpose(axes) * (side * (extent.high - extent.low));
            distance = std::max(distance, seen.z + std::max(std::abs(seen.x), std::abs(seen.y)) / tangent);
        }
    }
    // chosen: a margin of 5 %; 0 touches the border, 10 % looks lost.
    return 1.05 * distance;
}

/// A way of looking: a pivot that turns, and a camera at a distance from it.
struct Framing {
    View kind = View::orbit;
    glm::dvec3 pivot{0};
    double distance = 0;
    double elevation = 0;
    double start_yaw = 0;
    double facing = 0;        ///< mean cells in view that face the eye
    double turned_away = 0;   ///< mean cells in view that do not
    double least_facing = 0;  ///< as `facing`, of the emptiest heading; of a turn alone

    double share_turned_away() const { return core::divide_or(turned_away, facing + turned_away, 0.0); }
};

Framing judge_orbit(SurfaceGrid& grid, const Extent& extent) {
    Framing framing{View::orbit, extent.centre(), fitting_distance(extent, orbit_elevation), orbit_elevation, 0, 0, 0};
    for (int k = 0; k < headings; ++k) {
        const glm::dmat3 axes = axes_for(heading_of(k), -orbit_elevation);
        const SurfaceGrid::Frame seen = grid.seen_from(framing.pivot + axes[2] * framing.distance, axes);
        framing.facing += seen.front / static_cast<double>(headings);
        framing.turned_away += seen.back / static_cast<double>(headings);
    }
    return framing;
}

/// The best of the level views from outside.
Framing judge_front(SurfaceGrid& grid, const Extent& extent) {
    Framing best{View::front, extent.centre(), fitting_distance(extent, front_elevation), front_elevation, 0, -1, 0};
    for (int k = 0; k < headings; ++k) {
        const glm::dmat3 axes = axes_for(heading_of(k), -front_elevation);
        const SurfaceGrid::Frame seen = grid.seen_from(best.pivot + axes[2] * best.distance, axes);
        if (seen.front <= best.facing) continue;
        best.facing = seen.front;
        best.turned_away = seen.back;
        best.start_yaw = heading_of(k);
    }
    return best;
}

/// The best place within the extent to turn about at: the one that shows most detail, since the makers of a scene spend
/// their triangles where they mean to look.
Framing judge_turn(const Animation& animation, const Extent& whole) {
    // Of a room with few triangles the walls may lie outside the middle of them: take the middle only where it is much
    // smaller than the whole, and not a mere point.
    Extent extent = detailed_extent_at(animation, 0);
    if (extent.radius() > most_trimmed * whole.radius() || extent.radius() < least_trimmed * whole.radius())
        extent = whole;
    SurfaceGrid grid(animation, 0, extent);

    Framing best{View::turn, extent.centre(), 0, 0, 0, 0, 0};
    double most_detail = 0;
    constexpr std::array<double, 5> across{0.5, 0.35, 0.65, 0.2, 0.8};
    constexpr std::array<double, 3> high{0.35, 0.2, 0.6};
    for (const double y : high)
        for (const double x : across)
            for (const double z : across) {
                const glm::dvec3 eye = extent.low + glm::dvec3(x, y, z) * (extent.high - extent.low);
                if (!grid.is_free(eye)) continue;
                double facing = 0, least = 1e9, detail = 0, best_heading = -1, best_yaw = 0;
                for (int k = 0; k < headings; ++k) {
                    const SurfaceGrid::Frame seen = grid.seen_from(eye, axes_for(heading_of(k), 0));
                    facing += seen.front / static_cast<double>(headings);
                    detail += seen.detail;
                    least = std::min(least, static_cast<double>(seen.front));
                    if (seen.detail <= best_heading) continue;
                    best_heading = seen.detail;
                    best_yaw = heading_of(k);
                }
                if (detail <= most_detail) continue;
                most_detail = detail;
                best.facing = facing;
                best.least_facing = least;
                best.pivot = eye;
                best.start_yaw = best_yaw;
            }
    return best;
}

bool may_be_room(const Animation& animation, const Extent& extent) {
    const glm::dvec3 size = extent.high - extent.low;
    return animation.objects.size() >= least_things && size.y >= least_height &&
           std::min(size.x, size.z) >= least_width;
}

Framing choose_framing(const Animation& animation) {
    const std::optional<Extent> extent = extent_of_film(animation);
    if (!extent || !(extent->radius() > 0))
        return {View::orbit, extent ? extent->centre() : glm::dvec3(0), 3, orbit_elevation, 0, 0, 0};
    SurfaceGrid grid(animation, 0, *extent);
    const Framing orbit = judge_orbit(grid, *extent);
    if (orbit.share_turned_away() < share_of_halls) {
        // Walls with outer sides hide a room that is open above: from within there is something all around.
        if (!may_be_room(animation, *extent)) return orbit;
        const Framing within = judge_turn(animation, *extent);
        const bool is_room = within.least_facing >= least_of_rooms && within.facing > gain_within * orbit.facing;
        return is_room ? within : orbit;
    }
    if (orbit.share_turned_away() > share_of_one_sided) {
        const Framing front = judge_front(grid, *extent);
        if (front.share_turned_away() < share_of_open_side) return front;
    }
    const Framing turn = judge_turn(animation, *extent);
    return turn.facing > gain_within * orbit.facing ? turn : orbit;
}

/// Rotation of a node about +y for the film. Where nothing else moves, for one period; in the studio for four seconds,
/// from the left past the front to the right.
Track track_of(int node, const Framing& framing, bool studio, double duration) {
    const bool sways = framing.kind == View::front;
    const double period = studio                        ? studio_period
                          : framing.kind == View::orbit ? orbit_period
                          : sways                       ? sway_period
                                                        : turn_period;
    const double length = duration > 0 ? duration : studio ? studio_seconds : period;
    // chosen: a quarter turn a key is within the half turn that a shortest path allows; 32 keys make a sine look
    // smooth.
    const double keys = (sways ? 32 : 4) * length / period;
    const int count = std::max(1, static_cast<int>(std::ceil(std::min(1e5, keys))));
    Track track;
    track.target = TrackTarget::rotation;
    track.index = node;
    track.width = 4;
    for (int k = 0; k <= count; ++k) {
        const double time = length * k / count, phase = 2 * glm::pi<double>() * time / period;
        const double yaw = studio ? studio_start - phase : framing.start_yaw + (sways ? 0.25 * std::sin(phase) : phase);
        track.times.push_back(static_cast<float>(time));
        track.values.insert(track.values.end(),
                            {0.0f, static_cast<float>(std::sin(yaw / 2)), 0.0f, static_cast<float>(std::cos(yaw / 2))});
    }
    return track;
}

/// `aspect`: width of the picture over its height, at most 1. Moves an orbit up or down and as near as it can go, so
/// that what the film shows fills the picture from all sides.
void fill_picture(const Animation& animation, Framing& framing, double aspect) {
    std::vector<glm::dvec3> points;
    // chosen: a film is looked at 33 times, one of very many vertices 5 times; dancers' arms are seen in between.
    std::size_t vertices = 0;
    for (const Mesh& mesh : animation.meshes) vertices += mesh.positions.size();
    const int looks = animation.duration > 0 ? (vertices < 400'000 ? 33 : 5) : 1;
    for (int k = 0; k < looks; ++k) {
        const Pose pose = pose_at(animation, animation.duration * k / std::max(1, looks - 1));
        for (const Object& object : animation.objects) {
            if (animation.stage >= 0 && &object == &animation.objects[static_cast<std::size_t>(animation.stage)])
                continue;
            const std::vector<glm::dvec3> positions = world_positions(animation, object, pose);
            // chosen: some 1,000 points of an object tell its outline.
            const std::size_t step = positions.size() / 1024 + 1;
            for (std::size_t i = 0; i < positions.size(); i += step) points.push_back(positions[i] - framing.pivot);
        }
        for (const Volume& volume : animation.volumes)
            for (const glm::dvec3& corner : world_corners(volume, pose)) points.push_back(corner - framing.pivot);
    }
    const double tangent = std::tan(0.5 * studio_fov);
    double rise = 0, distance = 0;
    constexpr int sides = 24, rounds = 3;
    for (int round = 0; round < rounds; ++round) {
        double highest = 0, lowest = 0, nearest = 0;
        for (int k = 0; k < sides; ++k) {
            const glm::dmat3 axes = axes_for(2 * glm::pi<double>() * k / sides, -framing.elevation);
            for (const glm::dvec3& p : points) {
                const glm::dvec3 seen = glm::transpose(axes) * (p - glm::dvec3(0, rise, 0));
                nearest = std::max(nearest, seen.z + std::max(std::abs(seen.x) / aspect, std::abs(seen.y)) / tangent);
                if (round == 0 || distance <= seen.z) continue;
                const double up = seen.y / (distance - seen.z);
                highest = std::max(highest, up);
                lowest = std::min(lowest, up);
            }
        }
        if (!(nearest > 0)) return;
        distance = nearest;
        if (round + 1 < rounds) rise += 0.5 * (highest + lowest) * distance / std::cos(framing.elevation);
    }
    framing.pivot.y += rise;
    // chosen: a margin of 12 %, room for the shadow.
    framing.distance = 1.12 * distance;
}

}  // namespace

AutomaticCamera add_automatic_camera(Animation& animation, bool in_studio) {
    Framing framing = choose_framing(animation);
    const bool studio = in_studio && framing.kind == View::orbit && !animation.objects.empty();
    if (studio) {
        framing.elevation = studio_elevation;
        fill_picture(animation, framing, 1);
    }

    Node pivot;
    pivot.name = "automatic camera's pivot";
    pivot.translation = framing.pivot;
    Node eye;
    eye.name = "automatic camera";
    eye.parent = static_cast<int>(animation.nodes.size());
    eye.translation = framing.distance * glm::dvec3(0, std::sin(framing.elevation), std::cos(framing.elevation));
    eye.rotation = glm::angleAxis(-framing.elevation, glm::dvec3(1, 0, 0));
    CameraLens lens;
    lens.name = automatic_name;
    lens.node = eye.parent + 1;
    // Within a room walls are near: a wider view.
    lens.vertical_fov = static_cast<float>(framing.kind == View::turn ? 1.4 * vertical_fov
                                           : studio                   ? studio_fov
                                                                      : vertical_fov);

    animation.tracks.push_back(track_of(eye.parent, framing, studio, animation.duration));
    animation.nodes.push_back(std::move(pivot));
    animation.nodes.push_back(std::move(eye));
    animation.cameras.push_back(std::move(lens));
    switch (framing.kind) {
        case View::front:
            return {"no camera: looks into the open side and sways", View::front};
        case View::turn:
            return {"no camera: turns about within the scene", View::turn};
        default:
            return {studio ? "no camera: turns slowly about the scene" : "no camera: orbits the scene", View::orbit};
    }
}

void fit_automatic_camera(Animation& animation, double aspect) {
    if (!(aspect < 1) || !(aspect > 0) || animation.cameras.size() != 1) return;
    const CameraLens& lens = animation.cameras.front();
    if (lens.name != automatic_name || lens.node < 1) return;
    Node& eye = animation.nodes[static_cast<std::size_t>(lens.node)];
    Node& pivot = animation.nodes[static_cast<std::size_t>(eye.parent)];
    Framing framing;
    framing.pivot = pivot.translation;
    framing.distance = glm::length(eye.translation) / aspect;
    framing.elevation = std::atan2(eye.translation.y, eye.translation.z);
    if (lens.vertical_fov == static_cast<float>(studio_fov)) fill_picture(animation, framing, aspect);
    pivot.translation = framing.pivot;
    eye.translation = framing.distance * glm::dvec3(0, std::sin(framing.elevation), std::cos(framing.elevation));
}

}  // namespace render2mpeg::scene
