#include "bench/subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/loop/render_job.h"
#include "bench/mover_scenes.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::bench {

Subject subject(const std::string& scene, int frame, int width, int height) {
    const std::vector<std::string> movers = names_of_mover_scenes();
    if (std::find(movers.begin(), movers.end(), scene) != movers.end())
        return subject(mover_scene(scene).build(), frame, width, height);
    app::RenderOptions options;
    options.input = scene;
    options.size = fmt::format("{}x{}", width, height);
    options.samples = 1;
    options.exposure = "0";
    const app::RenderJob made = app::prepare(options);
    return {made.animation, made.plan, made.rendering, made.snapshot(frame)};
}

Subject subject(scene::Animation animation, int frame, int width, int height) {
    Subject s;
    s.animation = std::make_shared<scene::Animation>(std::move(animation));
    s.plan = renderer::make_plan(scene::traits_of(*s.animation), {});
    s.settings.isa = core::detect_isa();
    s.world = scene::snapshot_at(*s.animation, frame, {frame, 25}, {width, height, 1.0f});
    return s;
}

}  // namespace render2mpeg::bench
