// Vertices of skinned and morphed objects. [glTF2, 3.7.2.2], [glTF2, 3.7.3.3]
//
// Joint matrices are composed and blended in double precision; the difference to single precision shows at joints far
// from the origin, where the inverse bind matrix and the joint's own matrix nearly cancel.
#include <cmath>
#include <glm/glm.hpp>

#include "scene/pose/pose.h"

namespace render2mpeg::scene {
namespace {

/// The weights of the object's morph targets now.
std::vector<float> morph_weights(const Object& object, const Pose& pose) {
    if (object.node >= 0)
        if (const std::vector<float>& animated = pose.weights[static_cast<std::size_t>(object.node)]; !animated.empty())
            return animated;
    return object.morph_weights;
}

/// World matrix of each joint applied to the bind pose.
std::vector<glm::dmat4> joint_matrices(const Skin& skin, const Pose& pose) {
    std::vector<glm::dmat4> matrices;
    matrices.reserve(skin.joints.size());
    for (std::size_t j = 0; j < skin.joints.size(); ++j)
        matrices.push_back(pose.world_of(skin.joints[j]) * skin.inverse_bind[j]);
    return matrices;
}

glm::dmat4 blend(const VertexJoints& joints, const std::vector<glm::dmat4>& matrices) {
    glm::dmat4 sum(0.0);
    for (std::size_t k = 0; k < joints.weight.size(); ++k)
        if (joints.weight[k] != 0.0f) sum += matrices[joints.joint[k]] * static_cast<double>(joints.weight[k]);
    return sum;
}

/// base + sum of weight x offset; targets without these offsets do nothing.
template <class Member>
std::vector<glm::dvec3> morphed(const std::vector<glm::vec3>& base, const Mesh& mesh, const std::vector<float>& weights,
                                Member offsets) {
    std::vector<glm::dvec3> shape(base.begin(), base.end());
    for (std::size_t t = 0; t < mesh.morph_targets.size() && t < weights.size(); ++t) {
        const std::vector<glm::vec3>& offset = mesh.morph_targets[t].*offsets;
        if (weights[t] == 0.0f || offset.empty()) continue;
        for (std::size_t v = 0; v < shape.size(); ++v)
            shape[v] += static_cast<double>(weights[t]) * glm::dvec3(offset[v]);
    }
    return shape;
}

glm::vec3 normal_or(glm::dvec3 n, glm::vec3 otherwise) {
    const double length = glm::length(n);
    return length > 0 && std::isfinite(length) ? glm::vec3(n / length) : otherwise;
}

}  // namespace

std::vector<glm::dvec3> deformed_positions(const Animation& animation, const Object& object, const Pose& pose) {
    const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
    std::vector<glm::dvec3> shape = morphed(mesh.positions, mesh, morph_weights(object, pose), &MorphTarget::positions);
    if (object.skin < 0) {
        const glm::dmat4 to_world = pose.world_of(object.node);
        for (glm::dvec3& p : shape) p = glm::dvec3(to_world * glm::dvec4(p, 1));
        return shape;
    }
    const std::vector<glm::dmat4> matrices =
        joint_matrices(animation.skins[static_cast<std::size_t>(object.skin)], pose);
    for (std::size_t v = 0; v < shape.size(); ++v)
        shape[v] = glm::dvec3(blend(mesh.joints[v], matrices) * glm::dvec4(shape[v], 1));
    return shape;
}

std::vector<glm::vec3> deformed_normals(const Animation& animation, const Object& object, const Pose& pose) {
    const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
    const std::vector<glm::dvec3> shape =
        morphed(mesh.normals, mesh, morph_weights(object, pose), &MorphTarget::normals);
    std::vector<glm::vec3> normals(shape.size());
    if (object.skin < 0) {
        const glm::dmat3 matrix = normal_matrix(glm::dmat3(pose.world_of(object.node))).matrix;
        for (std::size_t v = 0; v < shape.size(); ++v) normals[v] = normal_or(matrix * shape[v], mesh.normals[v]);
        return normals;
    }
    const std::vector<glm::dmat4> matrices =
        joint_matrices(animation.skins[static_cast<std::size_t>(object.skin)], pose);
    for (std::size_t v = 0; v < shape.size(); ++v) {
        const NormalMatrix m = normal_matrix(glm::dmat3(blend(mesh.joints[v], matrices)));
        normals[v] = m.finite ? normal_or(m.matrix * shape[v], mesh.normals[v]) : mesh.normals[v];
    }
    return normals;
}

}  // namespace render2mpeg::scene
