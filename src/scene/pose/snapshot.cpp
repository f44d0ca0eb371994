#include "scene/pose/snapshot.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/box.h"
#include "core/error.h"
#include "core/numeric.h"
#include "scene/model/curves.h"
#include "scene/pose/extent.h"
#include "scene/pose/pose.h"
#include "scene/pose/posing.h"

namespace render2mpeg::scene {
namespace {

/// A unit axis in double precision; `otherwise` where v has no direction.
glm::dvec3 unit_or(glm::dvec3 v, glm::dvec3 otherwise) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

/// Transforms can multiply up to places that single precision does not have; lights and cameras stay on this side of
/// them.
glm::dvec3 within_reach(glm::dvec3 p) {
    for (int k = 0; k < 3; ++k) p[k] = std::isnan(p[k]) ? 0.0 : std::clamp(p[k], -farthest, farthest);
    return p;
}

glm::mat4 recentred(glm::dmat4 m, glm::dvec3 origin) {
    m[3] -= glm::dvec4(origin, 0);
    return glm::mat4(m);
}

bool is_finite(const std::vector<glm::vec3>& positions) {
    return std::all_of(positions.begin(), positions.end(), [](glm::vec3 p) { return core::is_finite(p); });
}

LightState pose_light(const Animation& animation, std::size_t index, const Pose& pose) {
    const Light& light = animation.lights[index];
    const glm::dmat4 to_world = pose.world_of(light.node);
    LightState state;
    state.id = static_cast<std::uint32_t>(index);
    state.kind = light.kind;
    state.position = glm::vec3(within_reach(glm::dvec3(to_world[3]) - animation.origin));
    state.direction = glm::vec3(unit_or(-glm::dvec3(to_world[2]), {0, 0, -1}));
    const float factor = pose.is_visible(light.node) ? std::max(0.0f, pose.light_factor[index]) : 0.0f;
    // chosen: 1e30, far above any real light, so that sums of light points stay in single precision.
    state.intensity = glm::min(pose.light_color[index] * (light.intensity * factor), glm::vec3(1e30f));
    state.range = light.range;
    // Below a fiftieth of the real sun's, a disc is a point, and its radiance stays finite.
    state.angle = light.kind == LightKind::directional && light.angle >= 1e-4f ? light.angle : 0.0f;
    state.disc = light.disc;
    state.seen = light.seen;
    if (light.kind == LightKind::spot) {
        state.cos_inner = std::cos(light.inner_cone);
        state.cos_outer = std::cos(light.outer_cone);
        state.smooth_cosine = light.smooth_cosine;
    }
    return state;
}

VolumeState pose_volume(const Animation& animation, const Volume& volume, std::int64_t frame, const Pose& pose) {
    VolumeState state;
    state.world_from_object = pose.world_of(volume.node);
    state.present = pose.is_visible(volume.node) && normal_matrix(glm::dmat3(state.world_from_object)).finite;
    state.world_from_object[3] -= glm::dvec4(animation.origin, 0);
    if (!volume.grids) state.file = volume.file_at(frame);
    return state;
}

glm::vec3 position_of(const Snapshot& snapshot, std::size_t object, std::uint32_t vertex) {
    const ObjectState& state = snapshot.objects[object];
    if (state.deformed >= 0) return snapshot.deformed[static_cast<std::size_t>(state.deformed)].positions[vertex];
    const Mesh& mesh = snapshot.animation->meshes[static_cast<std::size_t>(snapshot.animation->objects[object].mesh)];
    return glm::vec3(state.to_world * glm::vec4(mesh.positions[vertex], 1));
}

Camera camera_of(const CameraLens& lens, const glm::dmat4& to_world, float vertical_fov, glm::dvec3 origin,
                 PictureFormat format, Eye eye) {
    CameraLens at_instant = lens;
    at_instant.eye = eye;
    // A spline may leave the range of its keys.
    if (!lens.is_panorama()) at_instant.vertical_fov = std::clamp(vertical_fov, 1e-6f, 3.1415f);
    const float aspect = static_cast<float>(format.width) * format.pixel_aspect / static_cast<float>(format.height);
    return Camera(at_instant, rigid(to_world, origin), format.width, format.height, aspect);
}

/// Middle of the box about objects that are there; none where none is.
std::optional<glm::vec3> middle_of(const Snapshot& snapshot, const std::vector<int>& objects) {
    core::Box box;
    for (const int index : objects) {
        const auto object = static_cast<std::size_t>(index);
        if (!snapshot.objects[object].present) continue;
        const Mesh& mesh =
            snapshot.animation->meshes[static_cast<std::size_t>(snapshot.animation->objects[object].mesh)];
        for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) box.hold(position_of(snapshot, object, v));
    }
    return box.any() ? std::optional(box.middle()) : std::nullopt;
}

/// Focus distance and aperture of a thin lens (docs/model/exposure.md).
void open_aperture(const CameraLens& described, const Pose& pose, std::size_t camera, const Snapshot& snapshot,
                   PictureFormat format, Camera& result) {
    const float f_stop = pose.f_stop[camera];
    if (!(described.f_stop > 0) || !(f_stop > 0) || described.is_panorama()) return;
    CameraLens lens = result.lens();
    std::optional<glm::vec3> point;
    if (!described.focus_objects.empty())
        point = middle_of(snapshot, described.focus_objects);
    else if (described.focus_point)
        point = glm::vec3(*described.focus_point - snapshot.animation->origin);
    const float distance = point ? glm::dot(*point - result.position(), result.forward()) : pose.focus_distance[camera];
    // An orthographic camera's lens is as far open as that of the picture's height in focus would be.
    const float focal_length =
        result.has_eye() ? lens.sensor_height / (2 * std::tan(0.5f * lens.vertical_fov)) : lens.sensor_height;
    lens.aperture_radius = 0.5f * focal_length / f_stop;
    // Nothing can be in focus on the eye or behind it.
    lens.focus_distance = std::max(distance, 1e-3f * lens.aperture_radius);
    if (!std::isfinite(lens.focus_distance) || !std::isfinite(lens.aperture_radius)) return;
    const float aspect = static_cast<float>(format.width) * format.pixel_aspect / static_cast<float>(format.height);
    result = result.through(lens, aspect);
}

}  // namespace

ObjectState pose_object(const Animation& animation, const Object& object, const Pose& pose,
                        std::vector<DeformedMesh>& meshes) {
    ObjectState state;
    state.present = pose.is_visible(object.node);
    if (object.mobility == Mobility::deforming) {
        if (object.skin < 0 && !normal_matrix(glm::dmat3(pose.world_of(object.node))).finite) state.present = false;
        if (!state.present) return state;
        DeformedMesh deformed;
        for (const glm::dvec3& p : deformed_positions(animation, object, pose))
            deformed.positions.emplace_back(p - animation.origin);
        deformed.normals = deformed_normals(animation, object, pose);
        state.present = is_finite(deformed.positions);
        if (!state.present) return state;
        state.deformed = static_cast<int>(meshes.size());
        meshes.push_back(std::move(deformed));
        return state;
    }
    const glm::dmat4 to_world = pose.world_of(object.node);
    const NormalMatrix normal = normal_matrix(glm::dmat3(to_world));
    state.to_world = recentred(to_world, animation.origin);
    state.normal_to_world = glm::mat3(normal.matrix);
    state.present = state.present && normal.finite && core::is_finite(state.to_world);
    if (!state.present) {
        state.to_world = glm::mat4(1.0f);
        state.normal_to_world = glm::mat3(1.0f);
    }
    return state;
}

glm::mat4 rigid(const glm::dmat4& to_world, glm::dvec3 origin) {
    const glm::dvec3 back = unit_or(glm::dvec3(to_world[2]), {0, 0, 1});
    const glm::dvec3 fallback_up = std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, back.y > 0 ? -1 : 1);
    const glm::dvec3 wanted_up = unit_or(glm::dvec3(to_world[1]), fallback_up);
    glm::dvec3 right = glm::cross(wanted_up, back);
    // An up axis along the line of sight says nothing; 1e-9 leaves 7 digits of the right axis.
    if (!(glm::length(right) > 1e-9)) right = glm::cross(fallback_up, back);
    right = glm::normalize(right);
    const glm::dvec3 up = glm::cross(back, right);
    return glm::mat4(glm::dmat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0),
                                glm::dvec4(within_reach(glm::dvec3(to_world[3]) - origin), 1)));
}

int camera_at(const Animation& animation, std::int64_t frame) {
    if (animation.shots.empty()) return 0;
    int camera = animation.shots.front().camera;
    for (const Shot& shot : animation.shots)
        if (shot.frame <= frame) camera = shot.camera;
    return camera;
}

Snapshot snapshot_at(const Animation& animation, std::int64_t frame, core::Rational time, PictureFormat format,
                     const ShutterInterval& wanted, Eye eye) {
    EXPECTS(!animation.cameras.empty() && format.width > 0 && format.height > 0 && format.pixel_aspect > 0);
    const ShutterInterval shutter = within_shot(animation, frame, wanted);
    const Pose pose = pose_at(animation, time.value() + shutter.middle());
    Snapshot snapshot;
    snapshot.animation = &animation;
    snapshot.frame = frame;
    snapshot.time = time;
    snapshot.base_color = pose.base_color;
    snapshot.emission_factor = pose.emission_factor;
    for (float& factor : snapshot.emission_factor) factor = std::max(0.0f, factor);

    snapshot.objects.reserve(animation.objects.size());
    for (const Object& object : animation.objects)
        snapshot.objects.push_back(pose_object(animation, object, pose, snapshot.deformed));
    for (std::size_t i = 0; i < animation.lights.size(); ++i) snapshot.lights.push_back(pose_light(animation, i, pose));
    for (const Volume& volume : animation.volumes)
        snapshot.volumes.push_back(pose_volume(animation, volume, frame, pose));

    const int camera = camera_at(animation, frame);
    const CameraLens& lens = animation.cameras[static_cast<std::size_t>(camera)];
    snapshot.camera = camera_of(lens, pose.world_of(lens.node), pose.vertical_fov[static_cast<std::size_t>(camera)],
                                animation.origin, format, eye);
    open_aperture(lens, pose, static_cast<std::size_t>(camera), snapshot, format, snapshot.camera);
    snapshot.cut_before = eye != Eye::right && camera != camera_at(animation, frame - 1);
    if (shutter.is_open()) find_sweep(snapshot, pose, camera, shutter);
    snapshot.bends = bend_reflections(snapshot, pose, camera, shutter);
    return snapshot;
}

Triangle triangle_of(const Snapshot& snapshot, std::uint32_t object, std::uint32_t primitive) {
    const Animation& animation = *snapshot.animation;
    EXPECTS_DEBUG(object < animation.objects.size());
    const Mesh& mesh = animation.meshes[static_cast<std::size_t>(animation.objects[object].mesh)];
    EXPECTS_DEBUG(primitive < mesh.triangles.size());
    const glm::uvec3 corners = mesh.triangles[primitive];
    return {position_of(snapshot, object, corners.x), position_of(snapshot, object, corners.y),
            position_of(snapshot, object, corners.z)};
}

glm::dvec3 interpolated(const Mesh& mesh, const std::vector<glm::vec3>& positions,
                        const core::SurfaceAddress& address) {
    const double u = static_cast<double>(address.u), v = static_cast<double>(address.v);
    if (mesh.has_curves()) {
        // The strand's middle: it is hardly wider than a pixel, and what is seen of it turns with the eye.
        const CurveWeights weights(u);
        glm::dvec3 sum(0);
        for (std::uint32_t k = 0; k < 4; ++k)
            sum += weights.value[k] * glm::dvec3(positions[mesh.curves[address.primitive] + k]);
        return sum;
    }
    const glm::uvec3 corners = mesh.triangles[address.primitive];
    return (1 - u - v) * glm::dvec3(positions[corners.x]) + u * glm::dvec3(positions[corners.y]) +
           v * glm::dvec3(positions[corners.z]);
}

std::optional<glm::dvec3> carry_exact(const core::SurfaceAddress& address, const Snapshot& to) {
    if (!address.is_surface()) return std::nullopt;
    const ObjectState& state = to.objects[address.object];
    if (!state.present) return std::nullopt;

    // Interpolate in the space the vertices are in, then move the one point.
    const Mesh& mesh = to.animation->meshes[static_cast<std::size_t>(to.animation->objects[address.object].mesh)];
    const std::vector<glm::vec3>& positions =
        state.deformed >= 0 ? to.deformed[static_cast<std::size_t>(state.deformed)].positions : mesh.positions;
    const glm::dvec3 p = interpolated(mesh, positions, address);
    return state.deformed >= 0 ? p : glm::dvec3(glm::dmat4(state.to_world) * glm::dvec4(p, 1));
}

std::optional<glm::vec3> carry(const core::SurfaceAddress& address, const Snapshot& to) {
    const std::optional<glm::dvec3> p = carry_exact(address, to);
    return p ? std::optional(glm::vec3(*p)) : std::nullopt;
}

}  // namespace render2mpeg::scene
