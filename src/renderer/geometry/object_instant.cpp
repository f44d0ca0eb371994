#include "renderer/geometry/object_instant.h"

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

const scene::DeformedMesh* vertices_of(const scene::SweepKnot& knot, std::uint32_t object) {
    const int index = knot.objects[object].deformed;
    return index < 0 ? nullptr : &knot.deformed[static_cast<std::size_t>(index)];
}

/// Inverse transpose; `otherwise` where there is none.
glm::mat3 normals_by(const glm::mat3& m, const glm::mat3& otherwise) {
    const glm::mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    const glm::mat3 result = cofactors * (1.0f / glm::dot(m[0], cofactors[0]));
    return core::is_finite(result[0]) && core::is_finite(result[1]) && core::is_finite(result[2]) ? result : otherwise;
}

}  // namespace

ObjectInstant::ObjectInstant(const scene::Snapshot& snapshot, std::uint32_t object, float time)
    : snapshot_(snapshot),
      mesh_(snapshot.animation->meshes[static_cast<std::size_t>(snapshot.animation->objects[object].mesh)]),
      state_(&snapshot.objects[object]) {
    if (time == scene::middle_time || !snapshot.sweep || !snapshot.sweep->object_moves(object)) {
        if (state_->deformed >= 0) before_ = after_ = &snapshot.deformed[static_cast<std::size_t>(state_->deformed)];
        return;
    }
    const scene::Sweep& sweep = *snapshot.sweep;
    const scene::SweepPlace place(sweep.segments(), time);
    const scene::SweepKnot &first = sweep.knots[place.knot], &second = sweep.knots[place.knot + 1];
    share_ = place.share;
    before_ = vertices_of(first, object);
    after_ = vertices_of(second, object);
    if (before_ != nullptr) return;
    scene::ObjectState& moved = moved_.emplace(*state_);
    moved.to_world = (1.0f - share_) * first.objects[object].to_world + share_ * second.objects[object].to_world;
    moved.normal_to_world = normals_by(glm::mat3(moved.to_world), state_->normal_to_world);
    state_ = &moved;
}

glm::vec3 ObjectInstant::position(std::uint32_t vertex) const {
    if (before_ == nullptr) return glm::vec3(state_->to_world * glm::vec4(mesh_.positions[vertex], 1));
    if (before_ == after_) return before_->positions[vertex];
    return (1.0f - share_) * before_->positions[vertex] + share_ * after_->positions[vertex];
}

glm::vec3 ObjectInstant::normal(std::uint32_t vertex) const {
    if (before_ == nullptr) return mesh_.normals[vertex];
    if (before_ == after_) return before_->normals[vertex];
    return (1.0f - share_) * before_->normals[vertex] + share_ * after_->normals[vertex];
}

}  // namespace render2mpeg::renderer
