#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "scene/model/animation.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::test {

/// Tiny scenes made in code. Every `add_` function returns the index of what it added; `build` completes the film.
class SceneBuilder {
  public:
    /// A dull, white, single-sided material without any glossy lobe (ior 1), to be changed through `material`.
    int add_material(glm::vec3 color = {0.8f, 0.8f, 0.8f});
    int add_emitter(glm::vec3 radiance);
    scene::Material& material(int index) { return film_.materials.at(static_cast<std::size_t>(index)); }

    int add_mesh(scene::Mesh mesh);

    /// Places a mesh in the world at a node of its own.
    int add_object(int mesh, int material_index, glm::dvec3 at = {0, 0, 0}, glm::dquat turned = {1, 0, 0, 0},
                   glm::dvec3 scaled = {1, 1, 1});

    /// A parallelogram whose front is where cross(edge_u, edge_v) points; its uv run along the edges from (0, 0) to (1,
    /// 1).
    int add_quad(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, int material_index);
    /// An axis-aligned box, seen from outside (or from inside: a room).
    int add_box(glm::vec3 low, glm::vec3 high, int material_index, bool inside = false);
    /// A sphere of `rings` x 2 `rings` faces with smooth normals.
    int add_sphere(glm::vec3 centre, float radius, int material_index, int rings = 24);

    int add_point_light(glm::vec3 at, float intensity, glm::vec3 color = {1, 1, 1});
    /// Shines along `direction`; `irradiance` is across the beam.
    int add_sun(glm::vec3 direction, float irradiance, glm::vec3 color = {1, 1, 1});
    int add_light(scene::Light light);

    /// A perspective camera at `eye` that looks at `target`, +y up where it can be.
    int add_camera(glm::vec3 eye, glm::vec3 target, float vertical_fov = 0.9f);
    int add_camera(scene::CameraLens lens, glm::vec3 eye, glm::vec3 target);

    /// A linear track of `width` values at each of the times (seconds).
    void add_track(scene::TrackTarget target, int index, int width, std::vector<float> times,
                   std::vector<float> values);

    /// The node of an object moves through these places, one second apart.
    void move_object(int object, const std::vector<glm::vec3>& places);

    /// The film so far, not completed, for whatever has no function here.
    scene::Animation& film() { return film_; }
    const scene::Animation& unfinished() const { return film_; }

    /// Completed by scene::complete: adds a camera and a light where there is none.
    scene::Animation build() const;

    static scene::Mesh quad(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v);

    static scene::Mesh box(glm::vec3 low, glm::vec3 high, bool inside);

    static scene::Mesh sphere(float radius, int rings);

    static void append(scene::Mesh& mesh, const scene::Mesh& more);

    /// The rotation that takes -z to `direction` and +y as near to the world's +y as can be.
    static glm::dquat looking_along(glm::dvec3 direction);

  private:
    int add_node(glm::dvec3 at, glm::dquat turned, glm::dvec3 scaled);

    scene::Animation film_;
};

/// The film `seconds` after its start, at one frame per second, for a picture of this size, with the film's shutter.
scene::Snapshot snapshot(const scene::Animation& film, int seconds, int width, int height);

}  // namespace render2mpeg::test
