#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/color.h"
#include "renderer/anchor_places.h"
#include "renderer/cut.h"
#include "renderer/light_forest.h"
#include "renderer/light_points.h"
#include "renderer/photons.h"
#include "renderer/scenery.h"
#include "scene/traits.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::test {

/// What the lights of a stage are made with.
struct LightingSettings {
    int direct_points = 256;
    std::uint64_t paths = 0;  ///< photons; 0: no indirect light
    int bounces = 1;
    std::uint64_t set = 0;  ///< another set of light points and VPLs
    renderer::GeometryClamp clamp = renderer::GeometryClamp::none();
};

/// A built film, posed at one second, that can be lit.
class LitStage {
  public:
    explicit LitStage(const SceneBuilder& builder, int second = 0)
        : film_(std::make_unique<scene::Animation>(builder.build())),
          plan_(renderer::make_plan(scene::traits_of(*film_), {})),
          scenery_(*film_, core::detect_isa(), plan_),
          world_(std::make_unique<scene::Snapshot>(snapshot(*film_, second, 32, 32))) {
        scenery_.pose(*world_);
    }

    const renderer::Scenery& scenery() const { return scenery_; }
    const scene::Snapshot& world() const { return *world_; }

    std::vector<renderer::LightPoint> direct_points(int count, std::uint64_t seed) {
        renderer::LightPoints points(scenery_, plan_, count, seed);
        points.place(scenery_, *world_);
        return points.at(scenery_);
    }

    /// All light of the posed second.
    renderer::LightForest light(const LightingSettings& settings) {
        const std::vector<renderer::LightPoint> direct = direct_points(settings.direct_points, 1000 + settings.set);
        renderer::PhotonResult photons;
        if (settings.paths > 0)
            photons = renderer::trace_photons(scenery_, direct,
                                              {1 + settings.set * settings.paths, settings.paths, settings.bounces});
        std::vector<renderer::OrientedPoint> places;
        for (const renderer::LightPoint& v : photons.vpls) places.push_back({v.position, v.normal});
        const std::vector<float> areas = renderer::cell_areas(places, 1.0f);
        for (std::size_t i = 0; i < areas.size(); ++i) photons.vpls[i].disc2 = areas[i] / 3.14159265f;
        renderer::LightForest forest = renderer::plant(direct, photons.vpls, settings.set);
        forest.direct_clamp = forest.indirect_clamp = settings.clamp;
        forest.translucent = plan_.runs(renderer::Pass::alpha) || plan_.runs(renderer::Pass::glass);
        return forest;
    }

    /// A gather point on a surface, looked at from `outgoing`.
    renderer::GatherPoint point_at(std::uint32_t object, std::uint32_t primitive, glm::vec2 uv,
                                   glm::vec3 outgoing) const {
        renderer::GatherPoint point;
        point.point = scenery_.surface_at({object, primitive, uv.x, uv.y}, glm::normalize(outgoing));
        return point;
    }

  private:
    std::unique_ptr<scene::Animation> film_;
    renderer::Plan plan_;
    renderer::Scenery scenery_;
    std::unique_ptr<scene::Snapshot> world_;
};

/// Radiance that all light points together make a point scatter, and each tree's share of it.
struct Scattered {
    glm::dvec3 direct{0}, indirect{0}, glossy{0};
    glm::dvec3 all() const { return direct + indirect + glossy; }
};

inline Scattered gather_all(const LitStage& stage, const renderer::LightForest& forest,
                            const renderer::GatherPoint& point) {
    renderer::GatherLanes lanes;
    const renderer::GatherPoint* const points[] = {&point};
    renderer::fill(lanes, points);
    renderer::Gatherer gatherer(forest, stage.scenery().tracer());
    renderer::GatheredLight light;
    gatherer.gather_all(lanes, light);
    const renderer::Bsdf& b = point.point.bsdf;
    const glm::vec3 dull = b.diffuse / 3.14159265f;
    Scattered s{glm::dvec3(dull * light.direct.at(0)), glm::dvec3(dull * light.indirect.at(0)), glm::dvec3(0)};
    if (b.has_glossy()) s.glossy = glm::dvec3(b.f0 * light.f0.at(0) + light.schlick.at(0));
    return s;
}

}  // namespace render2mpeg::test
