#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/motion_field.h"
#include "core/tolerance_map.h"
#include "renderer/lights/light_points.h"
#include "renderer/lights/virtual_lights.h"
#include "renderer/tree/light_trees.h"
#include "renderer/view/see.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::test {

/// How the frames of a film are lit.
struct FilmLight {
    renderer::VirtualLightSettings virtual_lights;
    core::ToleranceMap tolerance = core::ToleranceMap::reference();
    bool direct = true, indirect = true;  ///< which light points there are
};

/// What frames took: CPU seconds of seeing and shading all of them, over all threads.
struct FilmCost {
    std::uint64_t shadow_rays = 0;
    double seconds = 0;
};

/// Luminance of each pixel of some frames on end, 25 a second.
using FrameLuminances = std::vector<core::Plane<float>>;

/// A film without textures whose frames are lit one after another, as a chunk of it is.
class MovingLightFilm {
  public:
    MovingLightFilm(const SceneBuilder& builder, int size);

    /// Adds to `cost`, if given.
    FrameLuminances lit(const FilmLight& light, int first, int count, FilmCost* cost = nullptr);

    /// Mean difference along motion between frames on end, as a share of their mean: of pixels that show the same thing
    /// in both.
    double flicker(const FrameLuminances& frames, int first);

  private:
    scene::Snapshot at(int frame) const { return scene::snapshot_at(*film_, frame, {frame, 25}, format_); }

    renderer::Frame see(const scene::Snapshot& world);

    core::Plane<float> shade(const scene::Snapshot& world, const renderer::LightTrees& light_trees,
                             const core::ToleranceMap& tolerance, FilmCost& cost);

    /// Light that the frame before has where a pixel was, if the same thing is all about there.
    static bool carried(const core::Plane<float>& light, const core::Visible& seen_before, const core::Visible& seen,
                        const core::MotionField& motion, int x, int y, float& then);

    std::unique_ptr<scene::Animation> film_;
    renderer::Plan plan_;
    renderer::PosedScene posed_scene_;
    scene::PictureFormat format_;
};

}  // namespace render2mpeg::test
