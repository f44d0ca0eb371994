#include "tests/renderer/virtual_light_stage.h"

#include <cmath>
#include <utility>

#include "scene/preparation/traits.h"

namespace render2mpeg::test {

VirtualLightStage::VirtualLightStage(const SceneBuilder& builder, renderer::VirtualLightSettings settings,
                                     int direct_points, std::uint64_t seed)
    : film_(builder.build()),
      plan_(renderer::make_plan(scene::traits_of(film_), {})),
      posed_scene_(film_, core::detect_isa(), plan_),
      points_(posed_scene_, plan_, direct_points, seed),
      world_(snapshot(film_, 0, 32, 32)),
      settings_(settings) {
    posed_scene_.pose(world_);
    points_.place(posed_scene_, world_);
    settings_.paths = renderer::virtual_light_paths(posed_scene_, points_.average(), settings.vpls, settings.bounces);
}

void VirtualLightStage::pose(double seconds) {
    const auto thousandths = static_cast<std::int64_t>(std::lround(seconds * 1000));
    scene::Snapshot next = scene::snapshot_at(film_, 0, {thousandths, 1000}, {32, 32, 1.0f});
    std::swap(world_, next);
    posed_scene_.pose(world_);
}

std::vector<renderer::LightPoint> VirtualLightStage::light() const {
    return renderer::virtual_lights(posed_scene_, {direct(), points_.average()}, settings_).vpls;
}

SceneBuilder hall() {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {8, 5, 12}, b.add_material({0.7f, 0.6f, 0.5f}), true);
    b.add_box({5.0f, 0, 3.0f}, {6.0f, 2.5f, 4.0f}, b.add_material({0.3f, 0.5f, 0.7f}));
    const int light = b.add_point_light({3, 2.5f, 2}, 20.0f, {1, 0.8f, 0.6f});
    scene::Track track;
    track.target = scene::TrackTarget::translation;
    track.index = b.film().lights[static_cast<std::size_t>(light)].node;
    track.times = {0, 2};
    track.values = {3, 2.5f, 2, 3, 2.5f, 9};
    b.film().tracks.push_back(track);
    return b;
}

}  // namespace render2mpeg::test
