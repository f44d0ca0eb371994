#include "tests/renderer/film_stage.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/color.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::test {

renderer::Settings small_frame(int width, int height) {
    renderer::Settings s;
    s.format = {width, height, 1.0f};
    s.samples = 1;
    s.direct_points = 256;
    s.cache = renderer::CacheUse::static_light;
    s.vpls = 500;  // where a test asks for lightcuts
    s.isa = core::detect_isa();
    return s;
}

renderer::Settings lightcuts_frame(int width, int height) {
    renderer::Settings s = small_frame(width, height);
    s.indirect = renderer::Indirect::lightcuts;
    s.cache = renderer::CacheUse::off;
    return s;
}

FilmStage::FilmStage(const SceneBuilder& builder, const renderer::Settings& settings, bool caustics)
    : film_(std::make_unique<scene::Animation>(builder.build())),
      settings_(settings),
      caustics_(caustics),
      renderer_(make(false)) {}

scene::Snapshot FilmStage::at(int second) const {
    return snapshot(*film_, second, settings_.format.width, settings_.format.height);
}

core::Radiance FilmStage::shade(int second, const core::ToleranceMap& tolerance) {
    const scene::Snapshot world = at(second);
    return renderer_->light(world, renderer_->look(world), {tolerance}).radiance;
}

core::ToleranceMap FilmStage::uniform(float relative) const {
    return core::ToleranceMap::uniform(settings_.format.width, settings_.format.height, {0.0f, relative});
}

core::Radiance FilmStage::cut(float relative, int second) {
    return shade(second, uniform(relative));
}

double FilmStage::share_beyond(const core::Radiance& frame, float relative, int second) {
    const scene::Snapshot world = at(second);
    const auto pixels = std::min(1024, static_cast<int>(frame.combined.size()));
    const renderer::Frame seen = renderer_->look(world);
    const renderer::Lit lit{{seen, renderer::UngatheredLight(seen)}, frame};
    const auto audited = renderer_->audit(world, lit, uniform(relative), pixels);
    const auto over =
        std::count_if(audited.begin(), audited.end(), [](const auto& p) { return p.error > p.tolerance; });
    return static_cast<double>(over) / static_cast<double>(pixels);
}

std::unique_ptr<renderer::Renderer> FilmStage::make(bool layers) const {
    renderer::Wanted wanted;
    wanted.layers = layers;
    wanted.indirect = settings_.vpls > 0;
    wanted.caustics = caustics_;
    wanted.by_rays = settings_.indirect == renderer::Indirect::rays;
    return std::make_unique<renderer::Renderer>(*film_, settings_,
                                                renderer::make_plan(scene::traits_of(*film_), wanted));
}

bool same_bytes(const core::Radiance& a, const core::Radiance& b) {
    return a.combined.size() == b.combined.size() && std::memcmp(a.combined.values().data(), b.combined.values().data(),
                                                                 a.combined.size() * sizeof(glm::vec3)) == 0;
}

double share_over(const core::Radiance& frame, const core::Radiance& truth, float relative) {
    int over = 0;
    for (std::size_t i = 0; i < truth.combined.size(); ++i) {
        const float expected = core::luminance(truth.combined.values()[i]);
        over += std::abs(core::luminance(frame.combined.values()[i]) - expected) > relative * expected ? 1 : 0;
    }
    return static_cast<double>(over) / static_cast<double>(truth.combined.size());
}

SceneBuilder furnished_room(float light) {
    SceneBuilder b;
    const int white = b.add_material({0.7f, 0.7f, 0.7f});
    b.add_box({0, 0, 0}, {4, 3, 4}, white, true);
    b.add_quad({1.5f, 2.99f, 1.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter({light, 0.9f * light, 0.7f * light}));
    b.add_sphere({1.2f, 0.6f, 1.5f}, 0.6f, b.add_material({0.7f, 0.2f, 0.1f}), 12);
    b.add_box({2.2f, 0, 0.8f}, {3.2f, 1.4f, 1.8f}, b.add_material({0.2f, 0.3f, 0.7f}));
    b.add_camera({2.0f, 1.6f, 3.8f}, {2.0f, 1.0f, 0.0f}, 1.1f);
    return b;
}

}  // namespace render2mpeg::test
