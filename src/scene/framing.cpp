// A camera for films that have none.
//
// An object is best seen from an orbit about it; a closed room shows an orbit nothing but the backs of its walls, and a
// room with an open side, like a Cornell box, is best seen through it. The three are judged alike, by how many cells of
// surface that face the eye a view shows on average (surface_grid.h), so that no scene needs to be recognised.
#include "scene/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/extent.h"
#include "scene/surface_grid.h"

namespace render2mpeg::scene {
namespace {

constexpr double vertical_fov = 0.6981317;  // 40 degrees: tangent 0.364 of half of it, as in surface_grid.cpp
constexpr double orbit_elevation = 0.35;    // radians: shows tops as well as sides
constexpr double front_elevation = 0.03;    // nearly level, so that the ceiling of a box does not hide its back wall
constexpr int headings = 8;
// chosen: a view must show a quarter more than the orbit before it replaces it; 1.1 .. 1.5 made no difference for ten
// scenes.
constexpr double preference_for_orbit = 1.25;
constexpr double orbit_period = 8, turn_period = 16, sway_period = 8;  // seconds

double heading_of(int k) {
    return 2 * glm::pi<double>() * k / headings;
}

/// Right, up and back of a camera that looks along -z, turned up by `pitch`, then to the left by `yaw`.
glm::dmat3 axes_for(double yaw, double pitch) {
    return glm::mat3_cast(glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0)));
}

/// Far enough to see the whole sphere about the extent.
double fitting_distance(const Extent& extent) {
    return extent.radius() / std::sin(0.5 * vertical_fov);
}

/// A way of looking: a pivot that turns, and a camera at a distance from it.
struct Framing {
    enum class Kind { orbit, front, turn } kind = Kind::orbit;
    glm::dvec3 pivot{0};
    double distance = 0;
    double elevation = 0;
    double start_yaw = 0;
    double score = 0;  ///< mean cells in view
};

Framing judge_orbit(SurfaceGrid& grid, const Extent& extent) {
    Framing framing{Framing::Kind::orbit, extent.centre(), fitting_distance(extent), orbit_elevation, 0, 0};
    for (int k = 0; k < headings; ++k) {
        const glm::dmat3 axes = axes_for(heading_of(k), -orbit_elevation);
        framing.score +=
            grid.cells_in_view(framing.pivot + axes[2] * framing.distance, axes) / static_cast<double>(headings);
    }
    return framing;
}

/// The best of the level views from outside.
Framing judge_front(SurfaceGrid& grid, const Extent& extent) {
    Framing best{Framing::Kind::front, extent.centre(), fitting_distance(extent), front_elevation, 0, -1};
    for (int k = 0; k < headings; ++k) {
        const glm::dmat3 axes = axes_for(heading_of(k), -front_elevation);
        const int cells = grid.cells_in_view(best.pivot + axes[2] * best.distance, axes);
        if (cells <= best.score) continue;
        best.score = cells;
        best.start_yaw = heading_of(k);
    }
    return best;
}

/// The best place within the extent to turn about at.
Framing judge_turn(SurfaceGrid& grid, const Extent& extent) {
    Framing best{Framing::Kind::turn, extent.centre(), 0, 0, 0, -1};
    constexpr std::array<double, 5> across{0.5, 0.3, 0.7, 0.15, 0.85};
    constexpr std::array<double, 4> high{0.35, 0.5, 0.2, 0.7};
    for (const double y : high)
        for (const double x : across)
            for (const double z : across) {
                const glm::dvec3 eye = extent.low + glm::dvec3(x, y, z) * (extent.high - extent.low);
                if (!grid.is_free(eye)) continue;
                double sum = 0, most = -1, best_yaw = 0;
                for (int k = 0; k < headings; ++k) {
                    const int cells = grid.cells_in_view(eye, axes_for(heading_of(k), 0));
                    sum += cells / static_cast<double>(headings);
                    if (cells <= most) continue;
                    most = cells;
                    best_yaw = heading_of(k);
                }
                if (sum <= best.score) continue;
                best.score = sum;
                best.pivot = eye;
                best.start_yaw = best_yaw;
            }
    return best;
}

/// The box about everything the film shows, looked at five times.
std::optional<Extent> extent_of_film(const Animation& animation) {
    std::optional<Extent> whole;
    for (int k = 0; k < 5; ++k) {
        const std::optional<Extent> now = extent_at(animation, animation.duration * k / 4);
        if (!now) continue;
        if (!whole) whole = now;
        whole->low = glm::min(whole->low, now->low);
        whole->high = glm::max(whole->high, now->high);
        if (animation.duration == 0) break;
    }
    return whole;
}

Framing choose_framing(const Animation& animation) {
    const std::optional<Extent> extent = extent_of_film(animation);
    if (!extent) return {Framing::Kind::orbit, glm::dvec3(0), 3, orbit_elevation, 0, 0};
    SurfaceGrid grid(animation, 0, *extent);
    Framing best = judge_orbit(grid, *extent);
    const double to_beat = preference_for_orbit * best.score;
    const Framing front = judge_front(grid, *extent), turn = judge_turn(grid, *extent);
    if (front.score > to_beat) best = front;
    if (turn.score > to_beat && turn.score > best.score) best = turn;
    return best;
}

/// Rotation keys about +y that last for the film, or for one period where nothing else moves.
Track turning_track(int node, const Framing& framing, double duration) {
    const bool sways = framing.kind == Framing::Kind::front;
    const double period = framing.kind == Framing::Kind::orbit ? orbit_period : sways ? sway_period : turn_period;
    const double length = duration > 0 ? duration : period;
    // chosen: a quarter turn a key is within the half turn that a shortest path allows; 32 keys make a sine look
    // smooth.
    const double keys_per_period = sways ? 32 : 4;
    const int keys = std::max(1, static_cast<int>(std::ceil(std::min(1e5, keys_per_period * length / period))));

    Track track;
    track.target = TrackTarget::rotation;
    track.index = node;
    track.width = 4;
    for (int k = 0; k <= keys; ++k) {
        const double seconds = length * k / keys, phase = 2 * glm::pi<double>() * seconds / period;
        const double yaw = framing.start_yaw + (sways ? 0.25 * std::sin(phase) : phase);
        track.times.push_back(static_cast<float>(seconds));
        track.values.insert(track.values.end(),
                            {0.0f, static_cast<float>(std::sin(yaw / 2)), 0.0f, static_cast<float>(std::cos(yaw / 2))});
    }
    return track;
}

}  // namespace

std::string add_automatic_camera(Animation& animation) {
    const Framing framing = choose_framing(animation);

    Node pivot;
    pivot.name = "automatic camera's pivot";
    pivot.translation = framing.pivot;
    Node eye;
    eye.name = "automatic camera";
    eye.parent = static_cast<int>(animation.nodes.size());
    eye.translation = framing.distance * glm::dvec3(0, std::sin(framing.elevation), std::cos(framing.elevation));
    eye.rotation = glm::angleAxis(-framing.elevation, glm::dvec3(1, 0, 0));
    CameraLens lens;
    lens.name = "automatic";
    lens.node = eye.parent + 1;
    // Within a room walls are near: a wider view.
    lens.vertical_fov = static_cast<float>(framing.kind == Framing::Kind::turn ? 1.4 * vertical_fov : vertical_fov);

    animation.tracks.push_back(turning_track(eye.parent, framing, animation.duration));
    animation.nodes.push_back(std::move(pivot));
    animation.nodes.push_back(std::move(eye));
    animation.cameras.push_back(std::move(lens));
    switch (framing.kind) {
        case Framing::Kind::front:
            return "no camera: looks into the open side and sways";
        case Framing::Kind::turn:
            return "no camera: turns about within the scene";
        default:
            return "no camera: orbits the scene";
    }
}

}  // namespace render2mpeg::scene
