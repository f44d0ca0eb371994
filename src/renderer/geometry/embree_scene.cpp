#include "renderer/geometry/embree_scene.h"

#include <cstring>

#include "core/error.h"
#include "core/numeric.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/geometry/embree.h"
#include "renderer/geometry/strands.h"
#include "renderer/geometry/surface_shape.h"
#include "scene/model/curves.h"

namespace render2mpeg::renderer {
namespace {

/// Still objects that share a mesh are copied into world space, which traces fastest, unless the copies have more
/// triangles than this. chosen: about 10 MB of vertices and tree; tried 0 (a tenth slower) and no limit (gigabytes for
/// sets of light trees).
constexpr std::size_t most_copied_triangles = 65536;

std::string name_of_error(RTCError code) {
    switch (code) {
        case RTC_ERROR_OUT_OF_MEMORY:
            return "out of memory";
        case RTC_ERROR_UNSUPPORTED_CPU:
            return "this processor is not supported";
        case RTC_ERROR_INVALID_ARGUMENT:
            return "invalid argument";
        case RTC_ERROR_INVALID_OPERATION:
            return "invalid operation";
        case RTC_ERROR_CANCELLED:
            return "cancelled";
        default:
            return "unknown error";
    }
}

/// Cofactors: they take normals of wound triangles to normals of the moved triangles, mirrored or not.
glm::mat3 cofactors(const glm::mat4& m) {
    const glm::vec3 x(m[0]), y(m[1]), z(m[2]);
    return {glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)};
}

}  // namespace

void EmbreeScene::ReleaseDevice::operator()(RTCDeviceTy* device) const {
    rtcReleaseDevice(device);
}
void EmbreeScene::ReleaseScene::operator()(RTCSceneTy* scene) const {
    rtcReleaseScene(scene);
}

EmbreeScene::EmbreeScene(const scene::Animation& animation, core::Isa isa, std::vector<bool> translucent, Filter filter)
    : animation_(animation),
      translucent_(std::move(translucent)),
      filter_(filter),
      still_(std::make_shared<Still>()),
      placed_(animation.objects.size()) {
    EXPECTS(translucent_.size() == animation.materials.size());
    const FlushDenormals flushed;
    still_->device.reset(rtcNewDevice((std::string("isa=") + core::name_of(isa)).c_str()));
    if (!still_->device) throw core::Error("starting Embree: " + name_of_error(rtcGetDeviceError(nullptr)));
    const auto remember = [](void* still, RTCError code, const char* text) {
        const std::lock_guard lock(static_cast<Still*>(still)->errors);
        std::string& first = static_cast<Still*>(still)->message;
        if (first.empty()) first = name_of_error(code) + (text != nullptr ? std::string(": ") + text : std::string());
    };
    rtcSetDeviceErrorFunction(still_->device.get(), remember, still_.get());

    // Decide object by object how it is placed.
    std::vector<std::size_t> users(animation.meshes.size(), 0);
    for (const scene::Object& object : animation.objects)
        if (object.mobility == scene::Mobility::still) ++users[static_cast<std::size_t>(object.mesh)];
    bool all_baked = true;
    for (std::size_t i = 0; i < placed_.size(); ++i) {
        const scene::Object& object = animation.objects[i];
        const auto mesh = static_cast<std::size_t>(object.mesh);
        const std::size_t copied = users[mesh] > 1 ? (users[mesh] - 1) * animation.meshes[mesh].primitives() : 0;
        if (object.mobility == scene::Mobility::deforming)
            placed_[i].kind = Kind::deforming;
        else if (object.mobility == scene::Mobility::rigid || copied > most_copied_triangles)
            placed_[i].kind = Kind::instanced;
        placed_[i].strands = animation.meshes[mesh].has_curves();
        all_baked = all_baked && placed_[i].kind == Kind::baked;
        any_translucent_ = any_translucent_ || is_filtered(static_cast<std::uint32_t>(i));
        const bool still = object.mobility == scene::Mobility::still;
        has_dynamic_objects_ = has_dynamic_objects_ || !still;
    }

    // Start with empty scenes: nothing is anywhere before it is posed.
    still_->baked = new_scene(false);
    rtcCommitScene(still_->baked.get());
    if (!all_baked) make_top();
    check("starting Embree");
}

EmbreeScene::EmbreeScene(const EmbreeScene& posed)
    : animation_(posed.animation_),
      translucent_(posed.translucent_),
      filter_(posed.filter_),
      still_(posed.still_),
      placed_(posed.placed_.size()),
      any_translucent_(posed.any_translucent_),
      has_dynamic_objects_(posed.has_dynamic_objects_) {
    const FlushDenormals flushed;
    for (std::size_t i = 0; i < placed_.size(); ++i) {
        const Placed& from = posed.placed_[i];
        placed_[i].kind = from.kind;
        placed_[i].strands = from.strands;
        if (from.kind != Kind::baked) continue;
        placed_[i].present = from.present;
        placed_[i].geometry = from.geometry;
        placed_[i].alone = from.alone;
        placed_[i].to_world = from.to_world;
    }
    if (posed.top_) make_top();
    check("starting Embree");
}

void EmbreeScene::make_top() {
    top_ = new_scene(true);
    baked_instance_ = new_instance(still_->baked.get(), static_cast<unsigned>(placed_.size()), baked_mask);
    rtcCommitScene(top_.get());
}

EmbreeScene::~EmbreeScene() = default;

void EmbreeScene::check(const char* doing) {
    const RTCError code = rtcGetDeviceError(still_->device.get());
    const std::lock_guard lock(still_->errors);
    if (code == RTC_ERROR_NONE && still_->message.empty()) return;
    throw core::Error(std::string(doing) + ": " +
                      (still_->message.empty() ? name_of_error(code) : std::exchange(still_->message, {})));
}

EmbreeScene::Scene EmbreeScene::new_scene(bool instances) const {
    Scene scene(rtcNewScene(still_->device.get()));
    const int flags = RTC_SCENE_FLAG_ROBUST | embree::filters_of_contexts |
                      (instances ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE);
    rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(flags));
    return scene;
}

bool EmbreeScene::is_filtered(std::uint32_t object) const {
    return translucent_[static_cast<std::size_t>(animation_.objects[object].material)];
}

bool EmbreeScene::is_still(std::uint32_t object) const {
    return animation_.objects[object].mobility == scene::Mobility::still;
}

/// The object's triangles or strands, in Embree's own buffers: it reads some bytes past the end of shared ones.
RTCGeometry EmbreeScene::new_triangles(std::span<const std::vector<glm::vec3>* const> steps, std::uint32_t object,
                                       float width) const {
    const auto mesh = static_cast<std::size_t>(animation_.objects[object].mesh);
    if (animation_.meshes[mesh].has_curves()) {
        RTCGeometry strands = new_strands(still_->device.get(), animation_.meshes[mesh], steps, width);
        if (is_filtered(object)) rtcSetGeometryOccludedFilterFunction(strands, filter_);
        rtcCommitGeometry(strands);
        return strands;
    }
    const std::vector<glm::uvec3>& triangles = animation_.meshes[mesh].triangles;
    RTCGeometry geometry = rtcNewGeometry(still_->device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps.size()));
    for (unsigned k = 0; k < steps.size(); ++k) {
        const std::vector<glm::vec3>& positions = *steps[k];
        void* const vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, k, RTC_FORMAT_FLOAT3,
                                                       sizeof(glm::vec3), positions.size());
        if (vertices != nullptr) std::memcpy(vertices, positions.data(), positions.size() * sizeof(glm::vec3));
    }
    void* const indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                  sizeof(glm::uvec3), triangles.size());
    if (indices != nullptr) std::memcpy(indices, triangles.data(), triangles.size() * sizeof(glm::uvec3));
    rtcSetGeometryMask(geometry, 0xffffffffu);  // Embree 4 starts with 1
    if (is_filtered(object)) rtcSetGeometryOccludedFilterFunction(geometry, filter_);
    rtcCommitGeometry(geometry);
    return geometry;
}

RTCGeometry EmbreeScene::new_instance(RTCScene of, unsigned id, unsigned mask) const {
    RTCGeometry instance = rtcNewGeometry(still_->device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, of);
    rtcSetGeometryMask(instance, mask);
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(top_.get(), instance, id);
    rtcReleaseGeometry(instance);
    return instance;
}

RTCScene EmbreeScene::shared_mesh(std::uint32_t object) {
    const int mesh = animation_.objects[object].mesh;
    const std::lock_guard lock(still_->building);
    Scene& scene = still_->meshes[{mesh, is_filtered(object)}];
    if (!scene) {
        scene = new_scene(false);
        RTCGeometry geometry = new_triangles(animation_.meshes[static_cast<std::size_t>(mesh)].positions, object);
        rtcAttachGeometryByID(scene.get(), geometry, 0);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene.get());
    }
    return scene.get();
}

void EmbreeScene::pose(const scene::Snapshot& snapshot) {
    EXPECTS(snapshot.animation == &animation_ && snapshot.objects.size() == placed_.size());
    const FlushDenormals flushed;
    bool baked_changed = false, top_changed = false;
    for (std::uint32_t i = 0; i < placed_.size(); ++i) {
        if (!place(i, snapshot)) continue;
        set_apart(i);
        (placed_[i].kind == Kind::baked ? baked_changed : top_changed) = true;
    }
    EXPECTS(!baked_changed || still_.use_count() == 1);
    if (baked_changed) rtcCommitScene(still_->baked.get());
    if (baked_changed && baked_instance_ != nullptr) rtcCommitGeometry(baked_instance_);
    if (top_ && (baked_changed || top_changed)) rtcCommitScene(top_.get());
    check("building the ray tracer's scene");
}

std::vector<MiddleBox> EmbreeScene::dynamic_object_boxes() const {
    std::vector<MiddleBox> boxes;
    for (std::uint32_t i = 0; i < placed_.size(); ++i) {
        const Placed& placed = placed_[i];
        if (!placed.present || is_still(i)) continue;
        RTCBounds bounds;
        rtcGetSceneBounds(placed.own ? placed.own.get() : placed.mesh, &bounds);
        const glm::vec3 low{bounds.lower_x, bounds.lower_y, bounds.lower_z},
            high{bounds.upper_x, bounds.upper_y, bounds.upper_z};
        if (!(low.x <= high.x)) continue;
        // The box about boxes that are turned.
        const auto turned = [&](const glm::mat4& m) {
            const glm::vec3 half = 0.5f * (high - low);
            return MiddleBox{glm::vec3(m * glm::vec4(0.5f * (low + high), 1.0f)),
                             half.x * glm::abs(glm::vec3(m[0])) + half.y * glm::abs(glm::vec3(m[1])) +
                                 half.z * glm::abs(glm::vec3(m[2]))};
        };
        MiddleBox box = turned(placed.own ? glm::mat4(1.0f) : placed.to_world);
        for (const glm::mat4& step : placed.steps) {
            const MiddleBox other = turned(step);
            const glm::vec3 least = glm::min(box.middle - box.half, other.middle - other.half),
                            most = glm::max(box.middle + box.half, other.middle + other.half);
            box = {0.5f * (least + most), 0.5f * (most - least)};
        }
        boxes.push_back(box);
    }
    return boxes;
}

/// Brings one object to where the snapshot has it; whether anything changed.
bool EmbreeScene::place(std::uint32_t object, const scene::Snapshot& snapshot) {
    const scene::ObjectState& state = snapshot.objects[object];
    Placed& placed = placed_[object];
    const bool deforms = placed.kind == Kind::deforming;
    const bool present = state.present && core::is_finite(state.to_world) && (!deforms || state.deformed >= 0);
    if (!present) {
        if (placed.present) rtcDisableGeometry(placed.geometry);
        return std::exchange(placed.present, false);
    }
    bool changed = false;
    switch (placed.kind) {
        case Kind::baked:
            changed = bake(object, state.to_world);
            break;
        case Kind::instanced:
            changed = move_instance(object, snapshot);
            break;
        case Kind::deforming:
            changed = deform(object, snapshot);
            break;
    }
    if (!placed.present) rtcEnableGeometry(placed.geometry);
    return !std::exchange(placed.present, true) || changed;
}

/// Gives an object that light goes below its scene `alone`.
void EmbreeScene::set_apart(std::uint32_t object) {
    Placed& placed = placed_[object];
    placed.alone = {};
    const auto material = static_cast<std::size_t>(animation_.objects[object].material);
    if (!placed.present || placed.strands || !animation_.materials[material].subsurface) return;
    Scene scene = new_scene(placed.kind != Kind::baked);
    rtcAttachGeometryByID(scene.get(), placed.geometry, 0);
    rtcCommitScene(scene.get());
    placed.alone = std::move(scene);
}

bool EmbreeScene::bake(std::uint32_t object, const glm::mat4& to_world) {
    Placed& placed = placed_[object];
    if (placed.geometry != nullptr && placed.to_world == to_world) return false;
    const auto mesh = static_cast<std::size_t>(animation_.objects[object].mesh);
    std::vector<glm::vec3> world = animation_.meshes[mesh].positions;
    for (glm::vec3& p : world) p = glm::vec3(to_world * glm::vec4(p, 1.0f));
    if (placed.geometry != nullptr) rtcDetachGeometry(still_->baked.get(), object);
    placed.geometry = new_triangles(world, object, scene::width_scale(to_world));
    rtcAttachGeometryByID(still_->baked.get(), placed.geometry, object);
    rtcReleaseGeometry(placed.geometry);
    placed.to_world = to_world;
    return true;
}

bool EmbreeScene::move_instance(std::uint32_t object, const scene::Snapshot& snapshot) {
    Placed& placed = placed_[object];
    const glm::mat4& to_world = snapshot.objects[object].to_world;
    std::vector<glm::mat4> steps;
    if (snapshot.sweep && snapshot.sweep->object_moves(object))
        for (const scene::SweepKnot& knot : snapshot.sweep->knots) steps.push_back(knot.objects[object].to_world);
    if (placed.geometry == nullptr || placed.steps.size() != steps.size()) {
        if (placed.geometry != nullptr) rtcDetachGeometry(top_.get(), object);
        placed.mesh = shared_mesh(object);
        placed.geometry = new_instance(placed.mesh, object, is_still(object) ? copied_mask : dynamic_mask);
        rtcSetGeometryTimeStepCount(placed.geometry, static_cast<unsigned>(std::max<std::size_t>(steps.size(), 1)));
    } else if (placed.to_world == to_world && placed.steps == steps) {
        return false;
    }
    if (steps.empty()) rtcSetGeometryTransform(placed.geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &to_world[0][0]);
    for (unsigned k = 0; k < steps.size(); ++k)
        rtcSetGeometryTransform(placed.geometry, k, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &steps[k][0][0]);
    rtcCommitGeometry(placed.geometry);
    placed.to_world = to_world;
    placed.wound_normal = cofactors(to_world);
    placed.steps = std::move(steps);
    return true;
}

glm::vec3 EmbreeScene::swept_normal(const Placed& placed, glm::vec3 normal, float time) {
    const scene::SweepPlace place(static_cast<int>(placed.steps.size()) - 1, time);
    return cofactors((1.0f - place.share) * placed.steps[place.knot] + place.share * placed.steps[place.knot + 1]) *
           normal;
}

bool EmbreeScene::deform(std::uint32_t object, const scene::Snapshot& snapshot) {
    Placed& placed = placed_[object];
    const auto vertices_in = [&](const auto& posed) -> const std::vector<glm::vec3>& {
        return posed.deformed[static_cast<std::size_t>(posed.objects[object].deformed)].positions;
    };
    std::vector<const std::vector<glm::vec3>*> steps;
    if (snapshot.sweep && snapshot.sweep->object_moves(object))
        for (const scene::SweepKnot& knot : snapshot.sweep->knots) steps.push_back(&vertices_in(knot));
    else
        steps.push_back(&vertices_in(snapshot));
    if (placed.geometry == nullptr) placed.own = new_scene(false);
    if (placed.geometry == nullptr || placed.vertex_steps != static_cast<int>(steps.size())) {
        if (placed.geometry != nullptr) rtcDetachGeometry(placed.own.get(), 0);
        placed.triangles = new_triangles(steps, object);
        rtcAttachGeometryByID(placed.own.get(), placed.triangles, 0);
        rtcReleaseGeometry(placed.triangles);
        rtcCommitScene(placed.own.get());
        placed.vertex_steps = static_cast<int>(steps.size());
        if (placed.geometry == nullptr)
            placed.geometry = new_instance(placed.own.get(), object, dynamic_mask);
        else
            rtcCommitGeometry(placed.geometry);
        return true;
    }
    bool changed = false;
    const bool strands = animation_.meshes[static_cast<std::size_t>(animation_.objects[object].mesh)].has_curves();
    for (unsigned k = 0; k < steps.size(); ++k) {
        void* const vertices = rtcGetGeometryBufferData(placed.triangles, RTC_BUFFER_TYPE_VERTEX, k);
        if (strands) {
            if (!move_strands(static_cast<glm::vec4*>(vertices), *steps[k])) continue;
            rtcUpdateGeometryBuffer(placed.triangles, RTC_BUFFER_TYPE_VERTEX, k);
            changed = true;
            continue;
        }
        const std::size_t bytes = steps[k]->size() * sizeof(glm::vec3);
        if (std::memcmp(vertices, steps[k]->data(), bytes) == 0) continue;
        std::memcpy(vertices, steps[k]->data(), bytes);
        rtcUpdateGeometryBuffer(placed.triangles, RTC_BUFFER_TYPE_VERTEX, k);
        changed = true;
    }
    if (!changed) return false;
    rtcCommitGeometry(placed.triangles);
    rtcCommitScene(placed.own.get());
    rtcCommitGeometry(placed.geometry);
    return true;
}

}  // namespace render2mpeg::renderer
