#include "bench/record_lobe_stage.h"

#include <fmt/format.h>

#include "app/loop/render_job.h"
#include "bench/record_lobe_trials.h"
#include "core/sampling.h"
#include "renderer/lights/anchors.h"
#include "renderer/view/see.h"

namespace render2mpeg::bench {

using renderer::GatherPoint;

constexpr int distances[distance_count] = {1, 2, 4};  ///< pixels

Stage stage_of(const std::string& scene, const bench::Wishes& wishes) {
    app::RenderOptions options;
    options.input = scene;
    const int size = wishes.number("size", 160);
    options.size = fmt::format("{0}x{0}", size);
    options.samples = 1;
    options.exposure = "0";
    options.vpls = wishes.number("vpls", 2000);
    const app::RenderJob film = app::prepare(options);
    const renderer::Settings& settings = film.rendering;
    const scene::Snapshot world = film.snapshot(wishes.number("frame", 0));
    Stage stage{film.animation, renderer::PosedScene(*film.animation, settings.isa, film.plan), {}, {}};
    stage.posed_scene.pose(world);
    renderer::LightPoints lights(stage.posed_scene, film.plan, settings.direct_points, settings.seed);
    const renderer::Anchors anchors(stage.posed_scene, lights, {settings.vpls, settings.bounces});
    lights.place(stage.posed_scene, world);
    const std::vector<renderer::LightPoint> direct = lights.at(stage.posed_scene);
    stage.light_trees = renderer::build_light_trees(direct, anchors.at(stage.posed_scene, direct).still, 1);
    stage.light_trees.point_clamp = renderer::GeometryClamp{0.25f};
    renderer::SeeCounts counts;
    stage.seen = renderer::see(stage.posed_scene, {{size, size, 1.0f}, 1, 0, settings.specular_depth, {}, {}},
                               film.plan, counts);
    return stage;
}

std::vector<Places> places_of(const renderer::Seen& seen, int count) {
    const int width = seen.visible.width(), height = seen.visible.height();
    std::vector<const GatherPoint*> of_pixel(static_cast<std::size_t>(width * height), nullptr);
    for (std::size_t t = 0; t < seen.tiles.size(); ++t)
        for (const GatherPoint& p : seen.tiles[t]) {
            const int x = static_cast<int>(t) % seen.tiles_across() * 16 + p.pixel % 16,
                      y = static_cast<int>(t) / seen.tiles_across() * 16 + p.pixel / 16;
            if (!p.reached_by_specular() && p.point.bsdf.has_glossy())
                of_pixel[static_cast<std::size_t>(y * width + x)] = &p;
        }
    std::vector<Places> found;
    for (std::uint64_t i = 0; found.size() < static_cast<std::size_t>(count) && i < 100000; ++i) {
        const int x = static_cast<int>(core::uniform(3, i) * static_cast<float>(width)),
                  y = static_cast<int>(core::uniform(4, i) * static_cast<float>(height));
        Places places;
        const auto take = [&](int px, int py) {
            if (px < 0 || py < 0 || px >= width || py >= height) return;
            const GatherPoint* p = of_pixel[static_cast<std::size_t>(py * width + px)];
            if (p == nullptr) return;
            if (!places.empty() && (places[0].point.address.object != p->point.address.object ||
                                    glm::dot(places[0].point.shading_normal, p->point.shading_normal) < 0.95f))
                return;
            places.push_back(*p);
        };
        take(x, y);
        for (const int d : distances)
            for (const glm::ivec2 s : {glm::ivec2(d, 0), glm::ivec2(-d, 0), glm::ivec2(0, d), glm::ivec2(0, -d)})
                take(x + s.x, y + s.y);
        if (places.size() == place_count) found.push_back(std::move(places));
    }
    return found;
}

}  // namespace render2mpeg::bench
