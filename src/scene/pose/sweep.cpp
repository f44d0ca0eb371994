#include "scene/pose/sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/box.h"
#include "core/numeric.h"
#include "scene/pose/extent.h"
#include "scene/pose/posing.h"

namespace render2mpeg::scene {
namespace {

/// Whether objects lie where they lie in the snapshot.
bool same_place(const SweepKnot& knot, const Snapshot& snapshot, std::size_t object) {
    const ObjectState &a = knot.objects[object], &b = snapshot.objects[object];
    if (b.deformed < 0) return a.to_world == b.to_world;
    return knot.deformed[static_cast<std::size_t>(a.deformed)].positions ==
           snapshot.deformed[static_cast<std::size_t>(b.deformed)].positions;
}

/// Objects at another instant of the shutter than the snapshot's; as there where they cannot be posed.
SweepKnot knot_at(const Snapshot& snapshot, double seconds, double middle, Pose& pose) {
    const Animation& animation = *snapshot.animation;
    pose = pose_at(animation, seconds, middle);
    SweepKnot knot;
    knot.objects.reserve(animation.objects.size());
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        const Object& object = animation.objects[i];
        const ObjectState& there = snapshot.objects[i];
        ObjectState state = object.mobility == Mobility::still || !there.present
                                ? there
                                : pose_object(animation, object, pose, knot.deformed);
        if (object.mobility != Mobility::still && (!state.present || state.deformed < 0) && there.deformed >= 0) {
            state.deformed = static_cast<int>(knot.deformed.size());
            knot.deformed.push_back(snapshot.deformed[static_cast<std::size_t>(there.deformed)]);
        } else if (!state.present) {
            state = there;
        }
        state.present = there.present;
        knot.objects.push_back(state);
    }
    return knot;
}

/// How far, in pixels, corners of objects' boxes at most lie off the straight way between two knots in the middle
/// between these.
float chord_error(const Snapshot& snapshot, const SweepKnot& before, const SweepKnot& between, const SweepKnot& after) {
    const Animation& animation = *snapshot.animation;
    const Camera& camera = snapshot.camera;
    float largest = 0;
    const auto take = [&](glm::vec3 a, glm::vec3 m, glm::vec3 b) {
        const float size = camera.pixel_extent(camera.depth_of(m));
        if (!(size > 0)) return;
        largest = std::max(largest, glm::length(m - 0.5f * (a + b)) / size);
    };
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        const ObjectState &a = before.objects[i], &m = between.objects[i], &b = after.objects[i];
        if (!m.present) continue;
        if (m.deformed >= 0) {
            const std::vector<glm::vec3>& pa = before.deformed[static_cast<std::size_t>(a.deformed)].positions;
            const std::vector<glm::vec3>& pm = between.deformed[static_cast<std::size_t>(m.deformed)].positions;
            const std::vector<glm::vec3>& pb = after.deformed[static_cast<std::size_t>(b.deformed)].positions;
            for (std::size_t v = 0; v < pm.size(); ++v) take(pa[v], pm[v], pb[v]);
            continue;
        }
        if (a.to_world == b.to_world && a.to_world == m.to_world) continue;
        const auto box =
            core::Box::about(animation.meshes[static_cast<std::size_t>(animation.objects[i].mesh)].positions);
        for (int c = 0; c < 8; ++c) {
            const glm::vec4 corner(box.corner(c), 1);
            take(glm::vec3(a.to_world * corner), glm::vec3(m.to_world * corner), glm::vec3(b.to_world * corner));
        }
    }
    return largest;
}

/// Segments that a sweep needs whose three first knots are these: halving them quarters what an arc is off by.
/// chosen: an eighth of a pixel; 2 to 8.
int segments_for(const Snapshot& snapshot, const SweepKnot& opening, const SweepKnot& middle,
                 const SweepKnot& closing) {
    constexpr float most_error = 0.125f;
    float error = chord_error(snapshot, opening, middle, closing) / 4;
    int segments = 2;
    for (; segments < 8 && error > most_error; error /= 4) segments *= 2;
    return segments;
}

bool camera_moves(const Animation& animation, int camera, const ShutterInterval& shutter, double time) {
    const CameraPath path(animation, camera);
    const double middle = time + shutter.middle();
    for (const double at :
         {time + shutter.opens, time + 0.75 * shutter.opens + 0.25 * shutter.closes, time + shutter.closes})
        if (path.to_world(at, middle) != path.to_world(middle, middle) ||
            path.vertical_fov(at, middle) != path.vertical_fov(middle, middle))
            return true;
    return false;
}

/// Light's mean while the shutter is open, by Simpson's rule: exact for cubic changes.
void average_light(const Pose& opening, const Pose& middle, const Pose& closing, Snapshot& snapshot) {
    const Animation& animation = *snapshot.animation;
    const auto mean = [](float a, float m, float b) {
        return (std::max(a, 0.0f) + 4 * std::max(m, 0.0f) + std::max(b, 0.0f)) / 6;
    };
    for (std::size_t i = 0; i < animation.lights.size(); ++i) {
        const float a = opening.light_factor[i], m = middle.light_factor[i], b = closing.light_factor[i];
        if (a == m && m == b) continue;
        const Light& light = animation.lights[i];
        const float factor = middle.is_visible(light.node) ? mean(a, m, b) : 0.0f;
        snapshot.lights[i].intensity = glm::min(light.color * (light.intensity * factor), glm::vec3(1e30f));
    }
    for (std::size_t i = 0; i < snapshot.emission_factor.size(); ++i) {
        const float a = opening.emission_factor[i], m = middle.emission_factor[i], b = closing.emission_factor[i];
        if (a != m || m != b) snapshot.emission_factor[i] = mean(a, m, b);
    }
}

}  // namespace

ShutterInterval within_shot(const Animation& animation, std::int64_t frame, const ShutterInterval& shutter) {
    ShutterInterval within = shutter;
    const double half = std::max(0.0, 0.5 * shutter.frame - std::abs(shutter.middle()));
    const bool begins = camera_at(animation, frame) != camera_at(animation, frame - 1),
               ends = camera_at(animation, frame) != camera_at(animation, frame + 1);
    if (begins || ends) {
        within.opens = std::max(shutter.opens, shutter.middle() - half);
        within.closes = std::min(shutter.closes, shutter.middle() + half);
        within.rolls = std::min(shutter.rolls, within.closes - within.opens);
    }
    return within;
}

void find_sweep(Snapshot& snapshot, const Pose& pose, int camera, const ShutterInterval& shutter) {
    const Animation& animation = *snapshot.animation;
    const double time = snapshot.time.value(), middle = time + shutter.middle();
    auto found = std::make_shared<Sweep>();
    found->shutter = shutter;
    found->camera_moves = camera_moves(animation, camera, shutter, time);

    const SweepKnot here{snapshot.objects, snapshot.deformed};
    Pose opening, closing, other;
    const SweepKnot first = knot_at(snapshot, time + shutter.opens, middle, opening),
                    last = knot_at(snapshot, time + shutter.closes, middle, closing);
    average_light(opening, pose, closing, snapshot);
    found->moves.assign(snapshot.objects.size(), 0);
    bool any = false;
    for (std::size_t i = 0; i < snapshot.objects.size(); ++i) {
        if (!snapshot.objects[i].present) continue;
        found->moves[i] = !same_place(first, snapshot, i) || !same_place(last, snapshot, i);
        any = any || found->moves[i] != 0;
    }
    if (any) {
        const int segments = segments_for(snapshot, first, here, last);
        for (int k = 0; k <= segments; ++k) {
            const double share = static_cast<double>(k) / segments;
            found->knots.push_back(
                2 * k == segments ? here
                                  : knot_at(snapshot, time + shutter.opens + share * (shutter.closes - shutter.opens),
                                            middle, other));
        }
    } else {
        found->moves.clear();
    }
    if (any || found->camera_moves) snapshot.sweep = std::move(found);
}

SweepPlace::SweepPlace(int segments, float time) {
    const float at = std::clamp(time, 0.0f, 1.0f) * static_cast<float>(segments);
    knot = static_cast<std::size_t>(std::min(static_cast<int>(at), segments - 1));
    share = at - static_cast<float>(knot);
}

std::vector<Camera> cameras_over(const Snapshot& snapshot, int count) {
    std::vector<Camera> cameras(static_cast<std::size_t>(count), snapshot.camera);
    if (!snapshot.sweep || !snapshot.sweep->camera_moves) return cameras;
    const Animation& animation = *snapshot.animation;
    const ShutterInterval& shutter = snapshot.sweep->shutter;
    const CameraPath path(animation, camera_at(animation, snapshot.frame));
    const double middle = snapshot.time.value() + shutter.middle();
    for (int k = 0; k < count; ++k) {
        const double share = (k + 0.5) / count;
        const double at = snapshot.time.value() + shutter.opens + share * (shutter.closes - shutter.opens);
        cameras[static_cast<std::size_t>(k)] =
            snapshot.camera.moved(rigid(path.to_world(at, middle), animation.origin), path.vertical_fov(at, middle));
    }
    return cameras;
}

std::optional<glm::vec3> swept_position(const core::SurfaceAddress& address, const Snapshot& snapshot, bool closing) {
    if (!address.is_surface()) return std::nullopt;
    if (!snapshot.sweep || !snapshot.sweep->object_moves(address.object)) return carry(address, snapshot);
    const SweepKnot& knot = closing ? snapshot.sweep->knots.back() : snapshot.sweep->knots.front();
    const ObjectState& state = knot.objects[address.object];
    const Mesh& mesh =
        snapshot.animation->meshes[static_cast<std::size_t>(snapshot.animation->objects[address.object].mesh)];
    const std::vector<glm::vec3>& positions =
        state.deformed >= 0 ? knot.deformed[static_cast<std::size_t>(state.deformed)].positions : mesh.positions;
    const glm::vec3 p(interpolated(mesh, positions, address));
    return state.deformed >= 0 ? p : glm::vec3(state.to_world * glm::vec4(p, 1));
}

}  // namespace render2mpeg::scene
