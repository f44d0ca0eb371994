#pragma once

#include <memory>
#include <vector>

#include "renderer/renderer.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::test {

/// Settings for small frames as films have them by default: rays that ask records.
renderer::Settings small_frame(int width = 24, int height = 24);

/// Likewise by cuts alone, the papers' own way, of few light points: references have all their light.
renderer::Settings lightcuts_frame(int width = 24, int height = 24);

/// A built film with a renderer, for small frames.
class FilmStage {
  public:
    /// `caustics`: whether frames have those that the plan wants.
    explicit FilmStage(const SceneBuilder& builder, const renderer::Settings& settings = small_frame(),
                       bool caustics = false);

    /// Starts anew, with all layers filled or not.
    void restart(bool layers) { renderer_ = make(layers); }

    scene::Snapshot at(int second) const;
    core::Radiance shade(int second, const core::ToleranceMap& tolerance);
    core::Radiance reference(int second = 0) { return shade(second, core::ToleranceMap::reference()); }
    core::Radiance cut(float relative, int second = 0);
    /// Share of pixels of the frame lit last, by `cut`, whose luminance is off by more than that share of what every
    /// light point sends to where they were lit (share_over: to where they were seen). Of large frames, of a thousand.
    double share_beyond(const core::Radiance& frame, float relative, int second);
    renderer::Renderer& renderer() { return *renderer_; }
    const renderer::Statistics& statistics() const { return renderer_->statistics(); }

  private:
    std::unique_ptr<renderer::Renderer> make(bool layers) const;
    core::ToleranceMap uniform(float relative) const;

    std::unique_ptr<scene::Animation> film_;
    renderer::Settings settings_;
    bool caustics_;
    std::unique_ptr<renderer::Renderer> renderer_;
};

bool same_bytes(const core::Radiance& a, const core::Radiance& b);

/// Share of pixels whose luminance is off by more than a share of the truth's.
double share_over(const core::Radiance& frame, const core::Radiance& truth, float relative);

/// A room lit by a panel in its ceiling, with a ball and a block: light of all orders.
SceneBuilder furnished_room(float light = 20.0f);

}  // namespace render2mpeg::test
