#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "core/color.h"
#include "renderer/anchors.h"
#include "renderer/light_forest.h"
#include "renderer/see.h"
#include "renderer/shade.h"
#include "scene/motion.h"
#include "scene/traits.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::test {

/// How the frames of a film are lit.
struct FilmLight {
    renderer::AnchorSettings anchors;
    core::ToleranceMap tolerance = core::ToleranceMap::reference();
    bool direct = true, still = true, moving = true;  ///< which light points there are
};

/// Luminance of each pixel of some frames on end, 25 a second.
using FrameLuminances = std::vector<core::Plane<float>>;

/// A film without textures whose frames are lit one after another, as a chunk of it is.
class MovingLightFilm {
  public:
    MovingLightFilm(const SceneBuilder& builder, int size)
        : film_(std::make_unique<scene::Animation>(builder.build())),
          plan_(renderer::make_plan(scene::traits_of(*film_), {})),
          scenery_(*film_, core::detect_isa(), plan_),
          format_{size, size, 1.0f} {}

    FrameLuminances lit(const FilmLight& light, int first, int count) {
        renderer::LightPoints points(scenery_, plan_, 128, 1);
        scene::Snapshot world = at(first);
        scenery_.pose(world);
        const renderer::Anchors anchors(scenery_, points, light.anchors);
        points.place(scenery_, world);
        renderer::LastingForest lasting({points.usual(), anchors.usual_still(), anchors.usual_moving()}, 1);
        FrameLuminances frames;
        for (int n = first; n < first + count; ++n) {
            scene::Snapshot next = at(n);
            std::swap(world, next);
            scenery_.pose(world);
            std::vector<renderer::LightPoint> direct = points.at(scenery_);
            renderer::Anchors::Lit lit = anchors.at(scenery_, direct);
            if (!light.direct) direct.clear();
            if (!light.still) lit.still.clear();
            if (!light.moving) lit.moving.clear();
            renderer::LightForest forest = lasting.at({direct, lit.still, lit.moving}, n == first);
            forest.direct_clamp = forest.indirect_clamp = {0.25f};
            frames.push_back(shade(world, forest, light.tolerance));
        }
        return frames;
    }

    /// Mean difference along motion between frames on end, as a share of their mean: of pixels that show the same thing
    /// in both.
    double flicker(const FrameLuminances& frames, int first) {
        double change = 0, sum = 0;
        for (int i = 1; i < static_cast<int>(frames.size()); ++i) {
            const scene::Snapshot before = at(first + i - 1), now = at(first + i);
            const core::Visible seen_before = see(before).visible, seen = see(now).visible;
            const core::MotionField motion = scene::motion_between(seen, now, before);
            for (int y = 0; y < format_.height; ++y)
                for (int x = 0; x < format_.width; ++x) {
                    float then = 0;
                    if (!carried(frames[static_cast<std::size_t>(i - 1)], seen_before, seen, motion, x, y, then))
                        continue;
                    const float light = frames[static_cast<std::size_t>(i)].at(x, y);
                    change += std::abs(static_cast<double>(light) - static_cast<double>(then));
                    sum += light;
                }
        }
        return sum > 0 ? change / sum : 0;
    }

  private:
    scene::Snapshot at(int frame) const { return scene::snapshot_at(*film_, frame, {frame, 25}, format_); }

    renderer::Seen see(const scene::Snapshot& world) {
        scenery_.pose(world);
        renderer::SeeCounts counts;
        return renderer::see(scenery_, {format_, 1, 0}, plan_, counts);
    }

    core::Plane<float> shade(const scene::Snapshot& world, const renderer::LightForest& forest,
                             const core::ToleranceMap& tolerance) {
        renderer::ShadeCounts counts;
        const renderer::Seen seen = see(world);
        const core::Radiance radiance =
            renderer::shade(forest, scenery_.tracer(), seen, world.camera.position(), tolerance, {}, counts);
        core::Plane<float> luminances(format_.width, format_.height);
        for (std::size_t i = 0; i < luminances.size(); ++i)
            luminances.values()[i] = core::luminance(radiance.combined.values()[i]);
        return luminances;
    }

    /// Light that the frame before has where a pixel was, if the same thing is all about there.
    static bool carried(const core::Plane<float>& light, const core::Visible& seen_before, const core::Visible& seen,
                        const core::MotionField& motion, int x, int y, float& then) {
        if (motion.kind.at(x, y) != core::PixelClass::surface) return false;
        const glm::vec2 p = glm::vec2(x, y) + motion.vector.at(x, y);
        const int x0 = static_cast<int>(std::floor(p.x)), y0 = static_cast<int>(std::floor(p.y));
        if (x0 < 0 || y0 < 0 || x0 + 1 >= light.width() || y0 + 1 >= light.height()) return false;
        const float s = p.x - static_cast<float>(x0), t = p.y - static_cast<float>(y0);
        then = 0;
        for (int k = 0; k < 4; ++k) {
            const int qx = x0 + k % 2, qy = y0 + k / 2;
            if (seen_before.address.at(qx, qy).object != seen.address.at(x, y).object) return false;
            then += (k % 2 ? s : 1 - s) * (k / 2 ? t : 1 - t) * light.at(qx, qy);
        }
        return true;
    }

    std::unique_ptr<scene::Animation> film_;
    renderer::Plan plan_;
    renderer::Scenery scenery_;
    scene::PictureFormat format_;
};

}  // namespace render2mpeg::test
