#include "renderer/cut/gatherer.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/error.h"
#include "core/standard_error.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/cut/bias_compensation.h"
#include "renderer/cut/finished_cut.h"

namespace render2mpeg::renderer {

void Gatherer::gather(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits,
                      GatheredLight& out) {
    const FlushDenormals flushed;
    out.clear_counts();
    shadows_.start(lanes);
    CutSums sums(lanes);

    // Gather the lights that are not clustered, each by itself.
    alignas(64) Lanes exact_luminance{};
    alignas(64) Lanes lamp_variance{};
    if (limits.exact) add_exact(lanes, {}, sums, exact_luminance, out);
    const LampAccuracy accuracy{.tolerance = &tolerance};
    if (limits.exact) add_lamps(lanes, Shadow::sharp, accuracy, {}, sums, exact_luminance, lamp_variance, out);
    add_lamps(lanes, Shadow::smooth, accuracy, {}, sums, exact_luminance, lamp_variance, out);

    // Start with the root of every tree, its representative tested by shadow rays.
    cut_.start(lanes, tolerance, limits, exact_luminance, shadows_);

    // Refine the cluster whose bound weighs most, until every point's estimated error is below its tolerance. Each
    // refinement tests the visibility of one more representative.
    while (cut_.can_refine() && !cut_.is_fine_enough()) cut_.refine();
    cut_.estimate_errors(out);
    for (int i = 0; i < lane_count; ++i)
        out.error[i] = std::hypot(out.error[i] / core::errors_of_one_in_hundred, std::sqrt(lamp_variance[i]));

    // Sum the light of the clusters, with the visibility of their representatives.
    sum_clusters(light_trees_, lanes, cut_.clusters(), sums, out);
    sums.store(out);
    out.shadow_rays = shadows_.rays();

    // Compensate the clamp of near lights.
    compensate_clamping_bias(light_trees_, tracer_, lanes, out);
}

void Gatherer::add_exact(const GatherLanes& lanes, std::span<LaneShadows> shadows, CutSums& sums, Lanes& luminance,
                         GatheredLight& out) {
    for (std::size_t l = 0; l < light_trees_.exact.size(); ++l) {
        const ExactLight& exact = light_trees_.exact[l];
        LightContribution contribution = LightContribution::unknown_in(0);
        shadows_.trace_from_places(exact.type, exact.light, &exact.spot, light_trees_.point_clamp,
                                   shadows.empty() ? nullptr : &shadows[l], contribution);
        const UnitLight unit = contribution.visible(lanes, light_trees_.translucent);
        add_luminance(lanes, unit, exact.light.intensity, luminance);
        sums.add(unit, exact.light.intensity, true);
        ++out.direct_clusters;
    }
}

/// `variance`: of the luminance, since lamps are sampled.
void Gatherer::add_lamps(const GatherLanes& lanes, Shadow shadow, LampAccuracy accuracy, std::span<LaneShadows> shadows,
                         CutSums& sums, Lanes& luminance, Lanes& variance, GatheredLight& out) {
    accuracy.luminance = &luminance;
    std::size_t next = 0;
    for (const auto& lamp : light_trees_.lamps) {
        if (lamp->sharp != (shadow == Shadow::sharp)) continue;
        accuracy.shadows = shadows.empty() ? nullptr : &shadows[next++];
        LampLight light;
        gather_lamp(*lamp, lanes, light_trees_.translucent, accuracy, shadows_, light);
        const UnitLight unit = light.visible(lanes, light_trees_.translucent);
        add_luminance(lanes, unit, lamp->radiance, luminance);
        sums.add(unit, lamp->radiance, true);
        for (int i = 0; i < lane_count; ++i) variance[i] += light.error[i] * light.error[i];
        ++out.direct_clusters;
    }
}

void Gatherer::gather_exact(const GatherLanes& lanes, Shadow shadow, const GroupTolerance* tolerance,
                            std::span<LaneShadows> shadows, GatheredLight& out) {
    EXPECTS(shadows.empty() || (shadow == Shadow::sharp && shadows.size() == light_trees_.sharp_lights()));
    const FlushDenormals flushed;
    out.clear_counts();
    shadows_.start(lanes);
    CutSums sums(lanes);
    alignas(64) Lanes luminance{}, variance{};
    if (shadow == Shadow::sharp) add_exact(lanes, shadows, sums, luminance, out);
    const LampAccuracy accuracy{.tolerance = tolerance, .one_point = tolerance == nullptr};
    const std::span<LaneShadows> of_lamps = shadows.empty() ? shadows : shadows.subspan(light_trees_.exact.size());
    add_lamps(lanes, shadow, accuracy, of_lamps, sums, luminance, variance, out);
    for (int i = 0; i < lane_count; ++i) out.error[i] = std::sqrt(variance[i]);
    sums.store(out);
    out.shadow_rays = shadows_.rays();
}

void Gatherer::gather_all(const GatherLanes& lanes, GatheredLight& out) {
    const FlushDenormals flushed;
    out.clear_counts();
    shadows_.start(lanes);
    CutSums sums(lanes);
    alignas(64) Lanes luminance{}, variance{};
    add_exact(lanes, {}, sums, luminance, out);
    for (const Shadow shadow : {Shadow::sharp, Shadow::smooth})
        add_lamps(lanes, shadow, LampAccuracy{}, {}, sums, luminance, variance, out);
    // Lanes without a ray in a packet keep their light.
    LightContribution contribution = LightContribution::unknown_in(0);
    for (int t = 0; t < LightTrees::tree_count; ++t) {
        const LightTree& tree = light_trees_.trees[t];
        for (std::uint32_t i = 0; i < tree.lights.size(); ++i) {
            const TreeLight& light = tree.lights[i];
            if (!(core::luminance(light.intensity) > 0.0f)) continue;
            shadows_.trace(tree.type, light, tree.spot(i), light_trees_.clamp(t), light_trees_.bodies_before(t),
                           contribution, t == LightTrees::dynamic_tree);
            const UnitLight unit = contribution.visible(lanes, light_trees_.translucent);
            sums.add(unit, light.intensity, LightTrees::is_direct(t));
            if (contribution.unit.any_clamped) sums.add_clamped(light, unit, light.intensity, light_trees_.clamp(t));
        }
        (LightTrees::is_direct(t) ? out.direct_clusters : out.indirect_clusters) +=
            static_cast<int>(tree.lights.size());
    }
    sums.store(out);
    out.shadow_rays = shadows_.rays();
    compensate_clamping_bias(light_trees_, tracer_, lanes, out);
}

void GatheredLight::clear_counts() {
    direct_clusters = indirect_clusters = 0;
    capped = 0;
    shadow_rays = 0;
    std::fill(std::begin(error), std::end(error), 0.0f);
}

}  // namespace render2mpeg::renderer
