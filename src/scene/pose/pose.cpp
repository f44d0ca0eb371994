#include "scene/pose/pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

namespace render2mpeg::scene {
namespace {

/// A node's own transform while tracks change it.
struct LocalTransform {
    glm::dvec3 translation;
    glm::dquat rotation;
    glm::dvec3 scale;
};

glm::dmat4 compose(const LocalTransform& t) {
    const glm::dmat3 r = glm::mat3_cast(t.rotation);
    return {glm::dvec4(r[0] * t.scale.x, 0), glm::dvec4(r[1] * t.scale.y, 0), glm::dvec4(r[2] * t.scale.z, 0),
            glm::dvec4(t.translation, 1)};
}

/// Tracks that change a single number.
void apply_scalar(const Track& track, float value, std::vector<std::uint8_t>& own_visible, Pose& pose) {
    const std::size_t i = static_cast<std::size_t>(track.index);
    switch (track.target) {
        case TrackTarget::visibility:
            own_visible[i] = value >= 0.5f;
            break;
        case TrackTarget::light_intensity:
            pose.light_factor[i] = value;
            break;
        case TrackTarget::emission:
            pose.emission_factor[i] = value;
            break;
        case TrackTarget::field_of_view:
            pose.vertical_fov[i] = value;
            break;
        case TrackTarget::f_stop:
            pose.f_stop[i] = value;
            break;
        case TrackTarget::focus_distance:
            pose.focus_distance[i] = value;
            break;
        case TrackTarget::reflection_radius:
            pose.reflection_radius[i] = value;
            break;
        case TrackTarget::reflection_border:
            pose.reflection_border[i] = value;
            break;
        default:
            break;
    }
}

/// Whether a track is looked at where steps are.
bool jumps(const Track& track) {
    return track.interpolation == Interpolation::step || track.target == TrackTarget::visibility;
}

/// Tracks that move a node; false for all others.
bool move_node(const Track& track, const std::array<float, 4>& v, LocalTransform& local) {
    switch (track.target) {
        case TrackTarget::translation:
            local.translation = {v[0], v[1], v[2]};
            return true;
        case TrackTarget::rotation:
            local.rotation = glm::normalize(glm::dquat(v[3], v[0], v[1], v[2]));
            return true;
        case TrackTarget::scale:
            local.scale = {v[0], v[1], v[2]};
            return true;
        default:
            return false;
    }
}

bool moves_nodes(const Track& track) {
    return track.target == TrackTarget::translation || track.target == TrackTarget::rotation ||
           track.target == TrackTarget::scale;
}

void apply(const Track& track, double seconds, std::vector<LocalTransform>& local,
           std::vector<std::uint8_t>& own_visible, Pose& pose) {
    const std::size_t i = static_cast<std::size_t>(track.index);
    if (track.target == TrackTarget::weights) {
        pose.weights[i].resize(static_cast<std::size_t>(track.width));
        track.sample(seconds, pose.weights[i]);
        return;
    }
    std::array<float, 4> v{};
    track.sample(seconds, v);
    switch (track.target) {
        case TrackTarget::light_color:
            pose.light_color[i] = glm::clamp(glm::vec3(v[0], v[1], v[2]), 0.0f, 1.0f);
            break;
        case TrackTarget::base_color:
            pose.base_color[i] = glm::clamp(glm::vec4(v[0], v[1], v[2], v[3]), 0.0f, 1.0f);
            break;
        default:
            if (!moves_nodes(track) || !move_node(track, v, local[i])) apply_scalar(track, v[0], own_visible, pose);
            break;
    }
}

}  // namespace

std::vector<int> parents_first(const std::vector<Node>& nodes) {
    // Count the children of each node, then walk from the roots down.
    std::vector<std::vector<int>> children(nodes.size());
    std::vector<int> order;
    order.reserve(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].parent < 0)
            order.push_back(static_cast<int>(i));
        else
            children[static_cast<std::size_t>(nodes[i].parent)].push_back(static_cast<int>(i));
    }
    for (std::size_t done = 0; done < order.size(); ++done) {
        const std::vector<int>& below = children[static_cast<std::size_t>(order[done])];
        order.insert(order.end(), below.begin(), below.end());
    }
    return order;
}

Pose pose_at(const Animation& animation, double seconds, double steps) {
    Pose pose;
    pose.to_world.resize(animation.nodes.size(), glm::dmat4(1.0));
    pose.visible.assign(animation.nodes.size(), 1);
    pose.weights.resize(animation.nodes.size());
    pose.light_factor.assign(animation.lights.size(), 1.0f);
    pose.emission_factor.assign(animation.materials.size(), 1.0f);
    for (const Light& light : animation.lights) pose.light_color.push_back(light.color);
    for (const Material& material : animation.materials) pose.base_color.push_back(material.base_color);
    for (const CameraLens& lens : animation.cameras) {
        pose.vertical_fov.push_back(lens.vertical_fov);
        pose.f_stop.push_back(lens.f_stop);
        pose.focus_distance.push_back(lens.focus_distance);
    }
    for (const Reflection& edit : animation.reflections) {
        pose.reflection_radius.push_back(edit.radius);
        pose.reflection_border.push_back(edit.border);
    }

    // Let the tracks, in their order, replace the values of the nodes.
    std::vector<LocalTransform> local;
    local.reserve(animation.nodes.size());
    for (const Node& node : animation.nodes) local.push_back({node.translation, node.rotation, node.scale});
    std::vector<std::uint8_t> own_visible(animation.nodes.size(), 1);
    for (const Track& track : animation.tracks) apply(track, jumps(track) ? steps : seconds, local, own_visible, pose);

    // Compose from the roots down.
    for (const int n : parents_first(animation.nodes)) {
        const std::size_t i = static_cast<std::size_t>(n);
        const Node& node = animation.nodes[i];
        const glm::dmat4 own = node.matrix ? *node.matrix : compose(local[i]);
        pose.to_world[i] = node.parent < 0 ? own : pose.world_of(node.parent) * own;
        pose.visible[i] = own_visible[i] != 0 && pose.is_visible(node.parent);
    }
    return pose;
}

CameraPath::CameraPath(const Animation& animation, int camera) : animation_(animation), camera_(camera) {
    for (int n = animation.cameras[static_cast<std::size_t>(camera)].node; n >= 0;
         n = animation.nodes[static_cast<std::size_t>(n)].parent)
        chain_.insert(chain_.begin(), n);
    for (const Track& track : animation.tracks) {
        const bool moves = moves_nodes(track) && std::find(chain_.begin(), chain_.end(), track.index) != chain_.end();
        if (moves || (track.target == TrackTarget::field_of_view && track.index == camera)) tracks_.push_back(&track);
    }
}

glm::dmat4 CameraPath::to_world(double seconds, double steps) const {
    glm::dmat4 world(1.0);
    for (const int n : chain_) {
        const Node& node = animation_.nodes[static_cast<std::size_t>(n)];
        LocalTransform local{node.translation, node.rotation, node.scale};
        for (const Track* track : tracks_) {
            if (track->index != n || !moves_nodes(*track)) continue;
            std::array<float, 4> v{};
            track->sample(jumps(*track) ? steps : seconds, v);
            move_node(*track, v, local);
        }
        world = world * (node.matrix ? *node.matrix : compose(local));
    }
    return world;
}

float CameraPath::vertical_fov(double seconds, double steps) const {
    float fov = animation_.cameras[static_cast<std::size_t>(camera_)].vertical_fov;
    for (const Track* track : tracks_)
        if (track->target == TrackTarget::field_of_view)
            track->sample(jumps(*track) ? steps : seconds, std::span<float>(&fov, 1));
    return fov;
}

NormalMatrix normal_matrix(const glm::dmat3& m) {
    // The inverse transpose is the cofactor matrix over the determinant; its columns are cross products of columns.
    const glm::dmat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    const double determinant = glm::dot(m[0], cofactor[0]);

    // Refuse what is singular beside its own size: all three scales of an object count, not their unit.
    // chosen: 1e-12; single precision vertices fall into one plane from 1e-7 on, and a shear of 1e6 still gives 1e-6.
    const double size = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
    if (!(std::abs(determinant) > 1e-12 * size) || !std::isfinite(determinant)) return {glm::dmat3(1.0), false};
    const glm::dmat3 inverse_transpose = cofactor * (1.0 / determinant);
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            if (!std::isfinite(static_cast<float>(inverse_transpose[c][r])) ||
                !std::isfinite(static_cast<float>(m[c][r])))
                return {glm::dmat3(1.0), false};
    return {inverse_transpose, true};
}

}  // namespace render2mpeg::scene
