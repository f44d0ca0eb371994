#pragma once

#include <cstdint>
#include <vector>

#include "renderer/lights/light_points.h"
#include "renderer/lights/virtual_lights.h"
#include "renderer/surface/posed_scene.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::test {

/// A film with virtual lights, to be posed at any of its seconds.
class VirtualLightStage {
  public:
    explicit VirtualLightStage(const SceneBuilder& builder, renderer::VirtualLightSettings settings = {600, 4},
                               int direct_points = 64, std::uint64_t seed = 1);

    void pose(double seconds);

    /// Of the posed second.
    std::vector<renderer::LightPoint> light() const;
    std::vector<renderer::LightPoint> direct() const { return points_.at(posed_scene_); }

    std::uint64_t paths() const { return settings_.paths; }
    const renderer::LightPoints& points() const { return points_; }
    const renderer::PosedScene& posed_scene() const { return posed_scene_; }

  private:
    scene::Animation film_;
    renderer::Plan plan_;
    renderer::PosedScene posed_scene_;
    renderer::LightPoints points_;
    scene::Snapshot world_;
    renderer::VirtualLightSettings settings_;
};

/// A hall in which a lamp moves 14 cm every 1/25 s, 2 m from the nearest wall.
SceneBuilder hall();

}  // namespace render2mpeg::test
