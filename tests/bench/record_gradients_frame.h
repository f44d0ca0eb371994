#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/loop/render_job.h"
#include "renderer/cache/record_fit.h"
#include "renderer/cache/record_groups.h"
#include "renderer/lights/anchors.h"
#include "renderer/lights/light_points.h"
#include "renderer/tree/light_trees.h"
#include "renderer/view/see.h"
#include "tests/bench/wishes.h"

namespace render2mpeg::bench {

/// A frame, its light, and records at every second pixel.
struct LatticeFrame {
    scene::Snapshot world;
    renderer::Seen seen;
    renderer::LightTrees light_trees;
    const renderer::RayTracer* tracer = nullptr;
    float floor = 0;

    struct At {
        renderer::PointRef ref;
        int x, y;
    };
    std::vector<At> places;  ///< of records
    std::vector<renderer::RecordMark> marks;
    std::vector<std::vector<std::uint32_t>> of_pixel;

    const renderer::GatherPoint& point(const renderer::PointRef& r) const { return seen.tiles[r.tile][r.index]; }
    int width() const { return seen.visible.width(); }
    int height() const { return seen.visible.height(); }
};

/// Where diffuse light is gathered.
std::vector<LatticeFrame::At> points_of(const LatticeFrame& frame);

/// Records of a lattice of `step` pixels that lie around a point on its surface.
struct LatticeSearch {
    const LatticeFrame& frame;
    const renderer::GatherPoint& point;
    glm::vec2 at{0};   ///< on the picture
    float extent = 0;  ///< of a pixel, world

    LatticeSearch(const LatticeFrame& f, const renderer::GatherPoint& p) : frame(f), point(p) {
        const auto seen = f.world.camera.project(p.point.position);
        if (!seen) return;
        at = seen->position;
        extent = f.world.camera.pixel_size() * (f.world.camera.perspective() ? seen->depth : 1.0f);
    }

    template <class Use>
    void each(int step, float reach, const Use& use) const {
        const renderer::SurfacePoint& p = point.point;
        const renderer::RecordMark here{
            at, 0, renderer::surface_of(p.address, p.back_side), p.position, p.geometric_normal, p.shading_normal};
        const int far = static_cast<int>(reach) + 2;
        const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
        for (int v = std::max(y - far, 0); v <= std::min(y + far, frame.height() - 1); ++v)
            for (int u = std::max(x - far, 0); u <= std::min(x + far, frame.width() - 1); ++u) {
                if (u % step != 0 || v % step != 0) continue;
                for (const std::uint32_t i : frame.of_pixel[static_cast<std::size_t>(v * frame.width() + u)]) {
                    const renderer::RecordMark& m = frame.marks[i];
                    const float apart = glm::length(m.at - at);
                    if (apart <= reach && on_one_surface(here, m, extent * apart, extent, p.position_error))
                        use(i, m, apart);
                }
            }
    }
};

/// A film whose frames can be lit.
class GradientFilm {
  public:
    GradientFilm(const std::string& input, const Wishes& wishes);

    LatticeFrame frame(int number);

  private:
    app::RenderJob film_;
    renderer::PosedScene posed_scene_{*film_.animation, film_.rendering.isa, film_.plan};
    renderer::LightPoints lights_{posed_scene_, film_.plan, film_.rendering.direct_points, film_.rendering.seed};
    std::optional<renderer::Anchors> anchors_;
};

}  // namespace render2mpeg::bench
