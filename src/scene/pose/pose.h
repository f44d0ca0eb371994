#pragma once
// Evaluates the tracks at one instant.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Values of all tracks at one instant, in double precision and in the file's own space (Animation::origin not
/// subtracted).
struct Pose {
    std::vector<glm::dmat4> to_world;           ///< per node
    std::vector<std::uint8_t> visible;          ///< per node, its ancestors included
    std::vector<std::vector<float>> weights;    ///< per node: morph weights, empty where no track moves them
    std::vector<float> light_factor;            ///< per light
    std::vector<float> emission_factor;         ///< per material
    std::vector<glm::vec3> light_color;         ///< per light
    std::vector<glm::vec4> base_color;          ///< per material
    std::vector<float> vertical_fov;            ///< per camera, radians
    std::vector<float> f_stop, focus_distance;  ///< per camera
    std::vector<float> reflection_radius, reflection_border;  ///< per edit

    /// World matrix of a node; -1 is the world itself.
    glm::dmat4 world_of(int node) const {
        return node < 0 ? glm::dmat4(1.0) : to_world[static_cast<std::size_t>(node)];
    }
    bool is_visible(int node) const { return node < 0 || visible[static_cast<std::size_t>(node)] != 0; }
};

/// Needs a valid animation (`complete`). `steps`: time at which jumping or switched tracks are evaluated; differs from
/// `seconds` while a shutter is open, during which nothing jumps.
Pose pose_at(const Animation& animation, double seconds, double steps);
inline Pose pose_at(const Animation& animation, double seconds) {
    return pose_at(animation, seconds, seconds);
}

/// A camera's node and lens at many instants: what moves them alone.
class CameraPath {
  public:
    /// `animation` outlives it.
    CameraPath(const Animation& animation, int camera);
    glm::dmat4 to_world(double seconds, double steps) const;
    /// Radians.
    float vertical_fov(double seconds, double steps) const;

  private:
    const Animation& animation_;
    int camera_;
    std::vector<int> chain_;  ///< nodes from the root down
    std::vector<const Track*> tracks_;
};

/// The nodes, each after its parent. Nodes in or below a cycle are missing, so that the list is shorter than the
/// animation's.
std::vector<int> parents_first(const std::vector<Node>& nodes);

/// Inverse transpose of a linear map, for normals; `finite` is false where the map is singular or too large or small
/// for single precision.
struct NormalMatrix {
    glm::dmat3 matrix{1.0};
    bool finite = true;
};
NormalMatrix normal_matrix(const glm::dmat3& m);

/// World positions of the vertices of an object that is skinned or morphed (single vertices, in the object's own
/// order), in the file's own space. Joint matrices are blended linearly. [glTF2, 3.7.3.3], [glTF2, 3.7.2.2]
std::vector<glm::dvec3> deformed_positions(const Animation& animation, const Object& object, const Pose& pose);

/// Their normals: unit; the mesh's own where the joints leave none. Empty where the mesh has none.
std::vector<glm::vec3> deformed_normals(const Animation& animation, const Object& object, const Pose& pose);

}  // namespace render2mpeg::scene
