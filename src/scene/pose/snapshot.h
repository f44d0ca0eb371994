#pragma once
// The scene at one instant.
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "core/rational.h"
#include "core/surface_address.h"
#include "scene/model/animation.h"
#include "scene/model/camera.h"
#include "scene/model/shutter.h"
#include "scene/pose/bent_reflections.h"

namespace render2mpeg::scene {

/// Where an object is at one instant.
struct ObjectState {
    glm::mat4 to_world{1.0f};         ///< of its mesh; identity for deforming objects
    glm::mat3 normal_to_world{1.0f};  ///< inverse transpose, not normalised
    bool present = true;              ///< false: scale 0 or switched off; has no surface at this instant
    int deformed = -1;                ///< index into Snapshot::deformed, or -1
};

/// Vertices of a deforming object, in world space.
struct DeformedMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  ///< unit; empty where the mesh has none
};

/// A punctual light in world space.
struct LightState {
    LightKind kind = LightKind::point;
    glm::vec3 position{0};
    glm::vec3 direction{0, 0, -1};  ///< it shines along this, unit
    glm::vec3 intensity{0};         ///< see Light::intensity; colour and tracks included
    float range = 0, cos_inner = 1, cos_outer = 0;
    float angle = 0;             ///< see Light::angle
    bool smooth_cosine = false;  ///< see Light::smooth_cosine
    float disc = 0;              ///< see Light::disc
    bool seen = false;           ///< see Light::seen
    std::uint32_t id = 0;        ///< index into Animation::lights

    bool operator==(const LightState&) const = default;
    bool is_distant() const { return kind == LightKind::directional; }
};

/// A volume at one instant.
struct VolumeState {
    glm::dmat4 world_from_object{1};  ///< about Animation::origin
    bool present = true;              ///< false: scale 0 or switched off
    std::size_t file = 0;             ///< of Volume::files

    bool operator==(const VolumeState&) const = default;
};

struct Sweep;

/// The whole animation at one instant. Keeps a reference to the animation, which must outlive it.
struct Snapshot {
    const Animation* animation = nullptr;
    std::int64_t frame = 0;
    core::Rational time;  ///< seconds
    std::vector<ObjectState> objects;
    std::vector<DeformedMesh> deformed;
    std::vector<LightState> lights;
    std::vector<float> emission_factor;  ///< per material, 1 where nothing animates it
    std::vector<glm::vec4> base_color;   ///< per material: Material::base_color, or what animates it
    Camera camera;
    /// The camera is another one than in the frame before; not of the right eye, which looks after the left one.
    bool cut_before = false;
    std::shared_ptr<const Sweep> sweep{};            ///< motion while the shutter is open (sweep.h); null: none
    std::shared_ptr<const BentReflections> bends{};  ///< edits of reflections in mirrors; null: none
    std::vector<VolumeState> volumes{};              ///< as the animation has them
};

/// Format of the pictures that a snapshot's camera is made for.
struct PictureFormat {
    int width = 0;
    int height = 0;
    float pixel_aspect = 1;  ///< width over height of one pixel as it is shown
};

/// The animation at frame `frame`, which lies at `time`, in the middle of the time that its shutter is open. A pure
/// function: no frame depends on another. Light that changes meanwhile has its mean.
Snapshot snapshot_at(const Animation& animation, std::int64_t frame, core::Rational time, PictureFormat format,
                     const ShutterInterval& shutter = {}, Eye eye = Eye::single);

/// World position of the three corners of a triangle at this instant.
struct Triangle {
    glm::vec3 a, b, c;
};
Triangle triangle_of(const Snapshot& snapshot, std::uint32_t object, std::uint32_t primitive);

/// The place at an address among these positions of its mesh: of a triangle, or of a strand's middle.
glm::dvec3 interpolated(const Mesh& mesh, const std::vector<glm::vec3>& positions, const core::SurfaceAddress& address);

/// Where the surface point is at this instant (docs/model/scene.md); nothing where its object is not present.
std::optional<glm::vec3> carry(const core::SurfaceAddress& address, const Snapshot& to);
/// The same before it is rounded to single precision.
std::optional<glm::dvec3> carry_exact(const core::SurfaceAddress& address, const Snapshot& to);

}  // namespace render2mpeg::scene
