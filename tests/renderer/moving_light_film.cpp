#include "tests/renderer/moving_light_film.h"

#include <cmath>
#include <ctime>

#include "core/color.h"
#include "renderer/cut/shade.h"
#include "scene/pose/motion.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::test {

MovingLightFilm::MovingLightFilm(const SceneBuilder& builder, int size)
    : film_(std::make_unique<scene::Animation>(builder.build())),
      plan_(renderer::make_plan(scene::traits_of(*film_), {})),
      posed_scene_(*film_, core::detect_isa(), plan_),
      format_{size, size, 1.0f} {}

FrameLuminances MovingLightFilm::lit(const FilmLight& light, int first, int count, FilmCost* cost) {
    FilmCost own;
    renderer::LightPoints points(posed_scene_, plan_, 128, 1);
    scene::Snapshot world = at(first);
    posed_scene_.pose(world);
    points.place(posed_scene_, world);
    renderer::VirtualLightSettings virtual_lights = light.virtual_lights;
    virtual_lights.paths = renderer::virtual_light_paths(posed_scene_, points.average(), virtual_lights.vpls, 0);
    renderer::PersistentLightTrees persistent(points.average(), 1);
    FrameLuminances frames;
    for (int n = first; n < first + count; ++n) {
        scene::Snapshot next = at(n);
        std::swap(world, next);
        posed_scene_.pose(world);
        std::vector<renderer::LightPoint> direct = points.at(posed_scene_);
        const std::vector<renderer::LightPoint> vpls =
            renderer::virtual_lights(posed_scene_, {direct, points.average()}, virtual_lights).vpls;
        if (!light.direct) direct.clear();
        renderer::LightTrees light_trees = persistent.at(direct, n == first);
        if (light.indirect)
            light_trees.trees[renderer::LightTrees::static_tree] =
                renderer::build_light_tree(renderer::LightType::oriented, vpls, 2);
        light_trees.point_clamp = {0.25f};
        frames.push_back(shade(world, light_trees, light.tolerance, cost != nullptr ? *cost : own));
    }
    return frames;
}

double MovingLightFilm::flicker(const FrameLuminances& frames, int first) {
    double change = 0, sum = 0;
    for (int i = 1; i < static_cast<int>(frames.size()); ++i) {
        const scene::Snapshot before = at(first + i - 1), now = at(first + i);
        const core::Visible seen_before = see(before).visible, seen = see(now).visible;
        const core::MotionField motion = scene::motion_between(seen, now, before);
        for (int y = 0; y < format_.height; ++y)
            for (int x = 0; x < format_.width; ++x) {
                float then = 0;
                if (!carried(frames[static_cast<std::size_t>(i - 1)], seen_before, seen, motion, x, y, then)) continue;
                const float light = frames[static_cast<std::size_t>(i)].at(x, y);
                change += std::abs(static_cast<double>(light) - static_cast<double>(then));
                sum += light;
            }
    }
    return sum > 0 ? change / sum : 0;
}

renderer::Frame MovingLightFilm::see(const scene::Snapshot& world) {
    posed_scene_.pose(world);
    renderer::SeeCounts counts;
    renderer::SeeSettings settings;
    settings.format = format_;
    settings.samples = 1;
    settings.specular_depth = 0;
    return renderer::see(posed_scene_, settings, plan_, counts);
}

core::Plane<float> MovingLightFilm::shade(const scene::Snapshot& world, const renderer::LightTrees& light_trees,
                                          const core::ToleranceMap& tolerance, FilmCost& cost) {
    const std::clock_t start = std::clock();
    renderer::ShadeCounts counts;
    const renderer::Frame seen = see(world);
    const renderer::UngatheredLight ungathered(seen);
    const renderer::LightingContext context{light_trees, posed_scene_.tracer(),   seen,
                                            ungathered,  world.camera.position(), tolerance};
    const core::Radiance radiance =
        renderer::shade(context, renderer::gather_light(context, {}, counts), false, counts);
    cost.shadow_rays += counts.shadow_rays;
    cost.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    core::Plane<float> luminances(format_.width, format_.height);
    for (std::size_t i = 0; i < luminances.size(); ++i)
        luminances.values()[i] = core::luminance(radiance.combined.values()[i]);
    return luminances;
}

bool MovingLightFilm::carried(const core::Plane<float>& light, const core::Visible& seen_before,
                              const core::Visible& seen, const core::MotionField& motion, int x, int y, float& then) {
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

}  // namespace render2mpeg::test
