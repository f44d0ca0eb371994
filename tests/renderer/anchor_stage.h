#pragma once

#include <memory>
#include <vector>

#include "renderer/lights/anchors.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::test {

/// A film whose anchors are chosen, to be posed at any of its seconds.
class AnchorStage {
  public:
    explicit AnchorStage(const SceneBuilder& builder, renderer::AnchorSettings settings = {600, 4});

    void pose(double seconds);
    renderer::Anchors::Lit light() { return anchors_->at(posed_scene_, points_.at(posed_scene_)); }
    renderer::PhotonResult photons();

    const renderer::Anchors& anchors() const { return *anchors_; }
    const renderer::LightPoints& points() const { return points_; }
    std::vector<renderer::LightPoint> direct() { return points_.at(posed_scene_); }
    const renderer::PosedScene& posed_scene() const { return posed_scene_; }

  private:
    scene::Animation film_;
    renderer::Plan plan_;
    renderer::PosedScene posed_scene_;
    renderer::LightPoints points_;
    scene::Snapshot world_;
    std::unique_ptr<renderer::Anchors> anchors_;
};

/// A hall in which a lamp moves 14 cm every 1/25 s, 2 m from the nearest wall.
SceneBuilder hall();

}  // namespace render2mpeg::test
