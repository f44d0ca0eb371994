#include "tests/renderer/lighting.h"

#include "core/color.h"
#include "renderer/lights/virtual_lights.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::test {

LitStage::LitStage(const SceneBuilder& builder, int second)
    : film_(std::make_unique<scene::Animation>(builder.build())),
      plan_(renderer::make_plan(scene::traits_of(*film_), {})),
      posed_scene_(*film_, core::detect_isa(), plan_),
      world_(std::make_unique<scene::Snapshot>(snapshot(*film_, second, 32, 32))) {
    posed_scene_.pose(*world_);
}

std::vector<renderer::LightPoint> LitStage::direct_points(int count, std::uint64_t seed) {
    renderer::LightPoints points(posed_scene_, plan_, count, seed);
    points.place(posed_scene_, *world_);
    return points.at(posed_scene_);
}

renderer::LightTrees LitStage::light(const LightingSettings& settings) {
    const std::vector<renderer::LightPoint> direct = direct_points(settings.direct_points, 1000 + settings.set);
    renderer::PhotonResult photons;
    if (settings.paths > 0)
        photons = renderer::trace_photons(posed_scene_, direct,
                                          {1 + settings.set * settings.paths, settings.paths, settings.bounces});
    renderer::spread(photons.vpls, 1.0f);
    renderer::LightTrees light_trees = build_light_trees(direct, photons.vpls, settings.set);
    light_trees.point_clamp = settings.clamp;
    light_trees.translucent = plan_.runs(renderer::Pass::alpha) || plan_.runs(renderer::Pass::glass);
    return light_trees;
}

renderer::GatherPoint LitStage::point_at(std::uint32_t object, std::uint32_t primitive, glm::vec2 uv,
                                         glm::vec3 outgoing) const {
    renderer::GatherPoint point;
    point.point = posed_scene_.surface_at({object, primitive, uv.x, uv.y}, glm::normalize(outgoing));
    return point;
}

Scattered gather_all(const LitStage& stage, const renderer::LightTrees& light_trees,
                     const renderer::GatherPoint& point) {
    renderer::GatherLanes lanes;
    const renderer::GatherPoint* const points[] = {&point};
    renderer::fill(lanes, points);
    renderer::Gatherer gatherer(light_trees, stage.posed_scene().tracer());
    renderer::GatheredLight light;
    gatherer.gather_all(lanes, light);
    const renderer::Bsdf& b = point.point.bsdf;
    const glm::vec3 dull = b.diffuse / 3.14159265f;
    Scattered s{glm::dvec3(dull * light.direct.at(0)), glm::dvec3(dull * light.indirect.at(0)), glm::dvec3(0)};
    if (b.has_glossy()) s.glossy = glm::dvec3(b.f0 * light.f0.at(0) + b.f90 * light.schlick.at(0));
    return s;
}

renderer::LightTrees build_light_trees(std::span<const renderer::LightPoint> direct,
                                       std::span<const renderer::LightPoint> vpls, std::uint64_t seed) {
    using renderer::LightTrees, renderer::LightType;
    LightTrees trees = renderer::PersistentLightTrees(direct, seed).at(direct);
    for (int t = 0; t < LightTrees::direct_trees; ++t) {
        std::vector<renderer::LightPoint> own;
        for (const renderer::LightPoint& p : direct)
            if (p.type == static_cast<LightType>(t) && (p.is_of_surface() || p.disc2 > 0.0f || trees.exact.empty()))
                own.push_back(p);
        trees.trees[t] = build_light_tree(static_cast<LightType>(t), own, seed);
    }
    trees.trees[LightTrees::static_tree] = build_light_tree(LightType::oriented, vpls, seed + 1);
    return trees;
}

}  // namespace render2mpeg::test
