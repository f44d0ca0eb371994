#include "record_gradients_frame.h"

#include <fmt/format.h>

#include "core/color.h"
#include "renderer/cache/record_gather.h"

namespace render2mpeg::bench {
namespace {

void lay_lattice(LatticeFrame& frame) {
    frame.of_pixel.assign(static_cast<std::size_t>(frame.width() * frame.height()), {});
    for (const LatticeFrame::At& at : points_of(frame)) {
        if (at.x % 2 != 0 || at.y % 2 != 0) continue;
        const renderer::SurfacePoint& p = frame.point(at.ref).point;
        const auto seen = frame.world.camera.project(p.position);
        if (!seen) continue;
        const auto index = static_cast<std::uint32_t>(frame.places.size());
        frame.of_pixel[static_cast<std::size_t>(at.y * frame.width() + at.x)].push_back(index);
        frame.places.push_back(at);
        frame.marks.push_back({seen->position, index, renderer::surface_of(p.address, p.back_side), p.position,
                               p.geometric_normal, p.shading_normal});
    }
}

app::RenderJob prepared(const std::string& input, const Wishes& wishes) {
    app::RenderOptions options;
    options.input = input;
    options.size = fmt::format("{0}x{0}", wishes.number("size", 192));
    options.samples = 1;
    options.vpls = wishes.number("vpls", 9000);
    options.exposure = "0";
    options.tolerance = "fixed=2%";
    return app::prepare(options);
}

}  // namespace

std::vector<LatticeFrame::At> points_of(const LatticeFrame& frame) {
    std::vector<LatticeFrame::At> all;
    const int across = frame.seen.tiles_across();
    for (std::uint32_t t = 0; t < frame.seen.tiles.size(); ++t)
        for (std::uint32_t i = 0; i < frame.seen.tiles[t].size(); ++i) {
            const renderer::GatherPoint& p = frame.seen.tiles[t][i];
            if (p.reached_by_specular || !(core::luminance(p.weight * p.point.bsdf.diffuse) > 0.0f)) continue;
            const int tile = static_cast<int>(t);
            all.push_back({{t, i},
                           tile % across * renderer::tile_size + p.pixel % renderer::tile_size,
                           tile / across * renderer::tile_size + p.pixel / renderer::tile_size});
        }
    return all;
}

GradientFilm::GradientFilm(const std::string& input, const Wishes& wishes) : film_(prepared(input, wishes)) {}

LatticeFrame GradientFilm::frame(int number) {
    LatticeFrame f;
    f.world = film_.snapshot(number);
    posed_scene_.pose(f.world);
    lights_.place(posed_scene_, f.world);
    if (!anchors_)
        anchors_.emplace(posed_scene_, lights_, renderer::AnchorSettings{film_.rendering.vpls, film_.rendering.bounces});
    const auto direct = lights_.at(posed_scene_);
    const renderer::Anchors::Lit lit = anchors_->at(posed_scene_, direct);
    const auto still = anchors_->usual_still(), moving = anchors_->usual_moving();
    renderer::PersistentLightTrees light_trees({lights_.usual(), still, moving}, film_.rendering.seed);
    f.light_trees = light_trees.at({direct, lit.still, lit.moving}, true);
    f.light_trees.direct_clamp = f.light_trees.indirect_clamp = {0.25f};  // renderer.cpp
    f.light_trees.translucent = film_.plan.runs(renderer::Pass::alpha) || film_.plan.runs(renderer::Pass::glass);
    f.tracer = &posed_scene_.tracer();
    f.floor = film_.tolerance_map().pixels.values()[0].absolute;
    renderer::SeeCounts counts;
    f.seen = renderer::see(posed_scene_, {film_.format, 1, film_.rendering.specular_depth}, film_.plan, counts);
    // Only diffuse light of what takes records.
    for (renderer::GatherTile& tile : f.seen.tiles)
        for (renderer::GatherPoint& p : tile) {
            if (!takes_records(p, {})) p.weight = glm::vec3(0);
            p.point.bsdf.f0 = glm::vec3(0);
        }
    lay_lattice(f);
    return f;
}

}  // namespace render2mpeg::bench
