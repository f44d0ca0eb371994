#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/color.h"
#include "renderer/cut.h"
#include "renderer/light_density.h"
#include "renderer/light_forest.h"
#include "renderer/light_points.h"
#include "renderer/photons.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::test {

/// What the lights of a stage are made with.
struct LightingSettings {
    int direct_points = 256;
    std::uint64_t paths = 0;   ///< photons; 0: no indirect light
    int bounces = 1;
    std::uint64_t set = 0;     ///< another set of light points and VPLs
    renderer::GeometryClamp clamp = renderer::GeometryClamp::none();
};

/// All light of a stage's posed second.
inline renderer::LightForest light(Stage& stage, const LightingSettings& settings) {
    renderer::LightPoints points(stage.scenery(), stage.plan(), settings.direct_points, 1000 + settings.set);
    stage.place(points);
    const std::vector<renderer::LightPoint> direct = points.at(stage.scenery());
    renderer::PhotonResult photons;
    if (settings.paths > 0)
        photons = renderer::trace_photons(stage.scenery(), direct,
                                          {1 + settings.set * settings.paths, settings.paths, settings.bounces});
    renderer::estimate_discs(photons.vpls);
    renderer::LightForest forest = renderer::plant(direct, photons.vpls, settings.set);
    forest.direct_clamp = forest.indirect_clamp = settings.clamp;
    return forest;
}

/// A gather point on a surface, looked at from `outgoing`.
inline renderer::GatherPoint point_at(const Stage& stage, std::uint32_t object, std::uint32_t primitive, glm::vec2 uv,
                                      glm::vec3 outgoing) {
    renderer::GatherPoint point;
    point.point = stage.scenery().surface_at({object, primitive, uv.x, uv.y}, glm::normalize(outgoing));
    return point;
}

/// Radiance that all light points together make a point scatter, and each tree's share of it.
struct Scattered {
    glm::dvec3 direct{0}, indirect{0}, glossy{0};
    glm::dvec3 all() const { return direct + indirect + glossy; }
};

inline Scattered gather_all(const Stage& stage, const renderer::LightForest& forest, const renderer::GatherPoint& point) {
    renderer::GatherLanes lanes;
    const renderer::GatherPoint* const points[] = {&point};
    renderer::fill(lanes, points);
    renderer::Gatherer gatherer(forest, stage.tracer());
    renderer::GatheredLight light;
    gatherer.gather_all(lanes, light);
    const renderer::Bsdf& b = point.point.bsdf;
    const glm::vec3 dull = b.diffuse / 3.14159265f;
    Scattered s{glm::dvec3(dull * light.direct.at(0)), glm::dvec3(dull * light.indirect.at(0)), glm::dvec3(0)};
    if (b.has_glossy()) s.glossy = glm::dvec3(b.f0 * light.f0.at(0) + light.schlick.at(0));
    return s;
}

}  // namespace render2mpeg::test
