#pragma once
// The scene's geometry in Embree, posed.
#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/isa.h"
#include "core/surface_address.h"
#include "renderer/base/light_packing.h"
#include "scene/pose/snapshot.h"

struct RTCDeviceTy;
struct RTCSceneTy;
struct RTCGeometryTy;
struct RTCFilterFunctionNArguments;

namespace render2mpeg::renderer {

/// The geometry of an animation in Embree's scenes, posed (docs/model/visibility.md). Part of RayTracer.
///
/// Triangles of still objects lie together in one scene, in world space; but many copies of a large mesh are instances
/// of it. If anything moves, or is such a copy, that scene is one instance of the scene that rays are traced in, and
/// every rigid, deforming or copied object is another. All trees are built anew from the posed instant and never
/// refitted, so that nothing depends on earlier ones.
class EmbreeScene {
  public:
    /// Called for shadow rays that meet a translucent object; see rtcSetGeometryOccludedFilterFunction.
    using Filter = void (*)(const RTCFilterFunctionNArguments*);

    EmbreeScene(const scene::Animation& animation, core::Isa isa, std::vector<bool> translucent, Filter filter);
    /// Of the same animation at other instants, with what `posed` shows of things that never move; they share it.
    EmbreeScene(const EmbreeScene& posed);
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    ~EmbreeScene();

    void pose(const scene::Snapshot& snapshot);

    /// World boxes of posed objects that move.
    std::vector<MiddleBox> dynamic_object_boxes() const;

    RTCSceneTy* root() const { return top_ ? top_.get() : still_->baked.get(); }

    /// Geometry that never moves, but for instances: the same as `root` where there are none. Embree never returns from
    /// some coherent packets that meet instances. Hence packets are traced here first and then, incoherently and with
    /// `instance_mask` in their rays, in `root`.
    RTCSceneTy* baked() const { return still_->baked.get(); }
    bool has_instances() const { return top_ != nullptr; }
    bool has_dynamic_objects() const { return has_dynamic_objects_; }

    /// Bits of a ray's mask in `root`: what lies in `baked`; what moves, changes its shape, comes or goes in the film;
    /// and instances that never do.
    static constexpr unsigned baked_mask = 1, dynamic_mask = 2, copied_mask = 4;
    static constexpr unsigned instance_mask = dynamic_mask | copied_mask;

    /// One object by itself, for walks below its surface; null for others than those, and where it is not present.
    RTCSceneTy* alone(std::uint32_t object) const { return placed_[object].alone.get(); }

    bool any_translucent() const { return any_translucent_; }
    bool is_instanced(std::uint32_t object) const { return placed_[object].kind == Kind::instanced; }

    /// The object that Embree means by an instance and a geometry id.
    std::uint32_t object_of(unsigned instance, unsigned geometry) const {
        const bool within_still = instance == no_instance || instance == placed_.size();
        return within_still ? geometry : instance;
    }

    /// Address of Embree's ids and barycentrics, which may lie outside by rounding.
    core::SurfaceAddress address(unsigned instance, unsigned geometry, unsigned primitive, float u, float v) const {
        return address(object_of(instance, geometry), primitive, u, v);
    }
    /// The same of an object that is known.
    core::SurfaceAddress address(std::uint32_t object, unsigned primitive, float u, float v) const {
        const float inside_u = std::clamp(u, 0.0f, 1.0f);
        // Embree counts across strands from -1 to 1.
        const float inside_v =
            placed_[object].strands ? std::clamp(0.5f + 0.5f * v, 0.0f, 1.0f) : std::clamp(v, 0.0f, 1.0f - inside_u);
        return {object, primitive, inside_u, inside_v};
    }

    /// An Embree normal in world space, along the triangle's winding there; any length.
    glm::vec3 world_normal(std::uint32_t object, glm::vec3 normal, float time) const {
        if (!is_instanced(object)) return normal;
        return placed_[object].steps.empty() ? placed_[object].wound_normal * normal
                                             : swept_normal(placed_[object], normal, time);
    }

    /// Whether a ray along `direction` meets the back of a triangle, whose normal in Embree's sense is this.
    bool is_back(std::uint32_t object, glm::vec3 normal, glm::vec3 direction, float time) const {
        const bool mirrored = glm::determinant(glm::mat3(placed_[object].to_world)) < 0.0f;
        return (glm::dot(world_normal(object, normal, time), direction) > 0.0f) != mirrored;
    }

  private:
    static constexpr unsigned no_instance = 0xffffffffu;
    struct ReleaseDevice {
        void operator()(RTCDeviceTy* device) const;
    };
    struct ReleaseScene {
        void operator()(RTCSceneTy* scene) const;
    };
    using Device = std::unique_ptr<RTCDeviceTy, ReleaseDevice>;
    using Scene = std::unique_ptr<RTCSceneTy, ReleaseScene>;

    enum class Kind { baked, instanced, deforming };
    struct Placed {
        Kind kind = Kind::baked;
        bool present = false, strands = false;
        RTCGeometryTy* geometry =
            nullptr;  ///< baked: in `Still::baked`; else the instance in `top_`. None until first present
        RTCSceneTy* mesh = nullptr;          ///< instanced: what it is an instance of
        RTCGeometryTy* triangles = nullptr;  ///< deforming: in `own`
        Scene own;                           ///< deforming
        std::shared_ptr<RTCSceneTy> alone;   ///< of `geometry` and nothing else
        glm::mat4 to_world{0.0f};
        glm::mat3 wound_normal{1.0f};  ///< instanced: cofactors of to_world
        std::vector<glm::mat4> steps;  ///< instanced: `to_world` evenly over the shutter; empty: it stays
        int vertex_steps = 1;          ///< deforming: of `triangles`
    };
    static glm::vec3 swept_normal(const Placed& placed, glm::vec3 normal, float time);
    /// What never moves: Embree's device and trees, of any number of scenes.
    struct Still {
        Device device;
        Scene baked;
        std::mutex building;
        std::map<std::pair<int, bool>, Scene> meshes;  ///< in their own space, without and with the filter
        std::mutex errors;
        std::string message;  ///< of Embree's first error since the last check
    };

    void make_top();
    Scene new_scene(bool instances) const;
    bool is_filtered(std::uint32_t object) const;
    /// `steps`: vertices evenly over the shutter, at least once. `width`: a factor on radii of strands.
    RTCGeometryTy* new_triangles(std::span<const std::vector<glm::vec3>* const> steps, std::uint32_t object,
                                 float width = 1.0f) const;
    RTCGeometryTy* new_triangles(const std::vector<glm::vec3>& positions, std::uint32_t object,
                                 float width = 1.0f) const {
        const std::vector<glm::vec3>* const still[] = {&positions};
        return new_triangles(still, object, width);
    }
    RTCGeometryTy* new_instance(RTCSceneTy* of, unsigned id, unsigned mask) const;
    RTCSceneTy* shared_mesh(std::uint32_t object);
    bool is_still(std::uint32_t object) const;
    bool place(std::uint32_t object, const scene::Snapshot& snapshot);
    void set_apart(std::uint32_t object);
    bool bake(std::uint32_t object, const glm::mat4& to_world);
    bool move_instance(std::uint32_t object, const scene::Snapshot& snapshot);
    bool deform(std::uint32_t object, const scene::Snapshot& snapshot);
    void check(const char* doing);

    const scene::Animation& animation_;
    std::vector<bool> translucent_;
    Filter filter_;
    std::shared_ptr<Still> still_;
    Scene top_;  ///< none where everything is baked
    RTCGeometryTy* baked_instance_ = nullptr;
    std::vector<Placed> placed_;
    bool any_translucent_ = false, has_dynamic_objects_ = false;
};

}  // namespace render2mpeg::renderer
