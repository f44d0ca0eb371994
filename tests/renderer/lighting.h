#pragma once

#include <memory>
#include <span>
#include <vector>

#include "renderer/cut/gatherer.h"
#include "renderer/lights/light_points.h"
#include "renderer/lights/photons.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/tree/light_trees.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::test {

/// What the lights of a stage are made with.
struct LightingSettings {
    int direct_points = 256;
    std::uint64_t paths = 0;  ///< photons; 0: no indirect light
    int bounces = 1;
    std::uint64_t set = 0;  ///< another set of light points and VPLs
    renderer::GeometryClamp clamp = renderer::GeometryClamp::none();
};

/// A built film, posed at one second, that can be lit.
class LitStage {
  public:
    explicit LitStage(const SceneBuilder& builder, int second = 0);

    const renderer::PosedScene& posed_scene() const { return posed_scene_; }
    const scene::Snapshot& world() const { return *world_; }

    std::vector<renderer::LightPoint> direct_points(int count, std::uint64_t seed);

    /// All light of the posed second.
    renderer::LightTrees light(const LightingSettings& settings);

    /// A gather point on a surface, looked at from `outgoing`.
    renderer::GatherPoint point_at(std::uint32_t object, std::uint32_t primitive, glm::vec2 uv,
                                   glm::vec3 outgoing) const;

  private:
    std::unique_ptr<scene::Animation> film_;
    renderer::Plan plan_;
    renderer::PosedScene posed_scene_;
    std::unique_ptr<scene::Snapshot> world_;
};

/// Light trees of direct light points, and of VPLs on still surfaces.
renderer::LightTrees build_light_trees(std::span<const renderer::LightPoint> direct,
                                       std::span<const renderer::LightPoint> vpls, std::uint64_t seed);

/// Radiance that all light points together make a point scatter, and each tree's share of it.
struct Scattered {
    glm::dvec3 direct{0}, indirect{0}, glossy{0};
    glm::dvec3 all() const { return direct + indirect + glossy; }
};

Scattered gather_all(const LitStage& stage, const renderer::LightTrees& light_trees,
                     const renderer::GatherPoint& point);

}  // namespace render2mpeg::test
