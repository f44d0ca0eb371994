#pragma once

#include <memory>
#include <utility>

#include "core/isa.h"
#include "renderer/view/see.h"
#include "scene/preparation/traits.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::test {

/// A built film with everything that seeing needs, posed at a second.
class Stage {
  public:
    explicit Stage(const SceneBuilder& builder, int width = 32, int height = 32, int second = 0)
        : film_(std::make_unique<scene::Animation>(builder.build())),
          plan_(renderer::make_plan(scene::traits_of(*film_), {})),
          posed_scene_(*film_, core::detect_isa(), plan_),
          width_(width),
          height_(height) {
        pose(second);
    }

    void pose(int second) {
        auto next = std::make_unique<scene::Snapshot>(snapshot(*film_, second, width_, height_));
        posed_scene_.pose(*next);
        world_ = std::move(next);
    }

    const scene::Animation& film() const { return *film_; }
    const renderer::Plan& plan() const { return plan_; }
    const renderer::PosedScene& posed_scene() const { return posed_scene_; }
    const renderer::RayTracer& tracer() const { return posed_scene_.tracer(); }
    const scene::Snapshot& world() const { return *world_; }

    renderer::Frame see(int samples = 1, int specular_depth = 6, int edge_samples = 0) {
        renderer::SeeSettings settings;
        settings.edge_samples = edge_samples;
        settings.format = {width_, height_, 1.0f};
        settings.samples = samples;
        settings.specular_depth = specular_depth;
        return renderer::see(posed_scene_, settings, plan_, counts_);
    }
    const renderer::SeeCounts& counts() const { return counts_; }

  private:
    std::unique_ptr<scene::Animation> film_;
    renderer::Plan plan_;
    renderer::PosedScene posed_scene_;
    std::unique_ptr<scene::Snapshot> world_;
    renderer::SeeCounts counts_;
    int width_, height_;
};

}  // namespace render2mpeg::test
