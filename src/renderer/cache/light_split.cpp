#include "renderer/cache/light_split.h"

#include <algorithm>
#include <iterator>

#include "core/color.h"
#include "renderer/cut/dynamic_objects.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {
namespace {

/// Largest share of anchors that may lie on moving objects. Beyond it, what they change is most of the light, and
/// gathering that for every frame takes longer than gathering all of it afresh. chosen: 0.05; of the films that were
/// tried 0.002 and 0.007 gain, and 0.18 would lose (docs/fits/records.md).
constexpr double most_moving = 0.05;

/// Once all still anchors together have changed by this share of what they shone, those of now are taken.
/// chosen: 0.02, not tuned: 0.027 take a fifth of a cut's rays at 2 %, 0.0003 a fiftieth (bench_delta_cuts).
constexpr double most_changed = 0.02;

}  // namespace

bool LightSplit::may_suit(const scene::Animation& film, const Plan& plan) {
    const scene::Traits traits = scene::traits_of(film);
    if (traits.lights_change || plan.runs(Pass::alpha) || plan.runs(Pass::glass) || plan.runs(Pass::air) ||
        !(traits.objects_move || traits.objects_deform))
        return false;
    int dynamic_objects = 0;
    for (const scene::Object& object : film.objects) {
        if (object.mobility == scene::Mobility::still) continue;
        if (film.materials[static_cast<std::size_t>(object.material)].emits()) return false;
        ++dynamic_objects;
    }
    return dynamic_objects <= GroupDynamicObjects::most;
}

bool LightSplit::suit(const PosedScene& posed_scene, const Plan& plan, std::size_t still_anchors,
                      std::size_t moving_anchors) {
    return may_suit(posed_scene.animation(), plan) &&
           static_cast<double>(moving_anchors) <= most_moving * static_cast<double>(still_anchors + moving_anchors);
}

bool LightSplit::update(const LightTrees& light_trees, std::span<const LightPoint> anchors,
                        const PersistentLightTrees& lasting) {
    const auto same = [](const LightPoint& a, const LightPoint& b) { return a.id == b.id; };
    double changed = 0, all = 0;
    const bool comparable = std::equal(anchors.begin(), anchors.end(), then_.begin(), then_.end(), same);
    std::vector<LightPoint> more, less;
    for (std::size_t i = 0; comparable && i < anchors.size(); ++i) {
        const glm::vec3 change = anchors[i].intensity - then_[i].intensity;
        changed += core::luminance(glm::abs(change));
        all += core::luminance(then_[i].intensity);
        more.push_back(anchors[i]);
        more.back().intensity = glm::max(change, glm::vec3(0));
        less.push_back(anchors[i]);
        less.back().intensity = glm::max(-change, glm::vec3(0));
    }
    const bool renews = !taken_ || !comparable || changed > most_changed * all;
    taken_ = true;

    LightTrees bare;
    bare.direct_clamp = light_trees.direct_clamp;
    bare.indirect_clamp = light_trees.indirect_clamp;
    bare.lobe_rays = light_trees.lobe_rays;
    constexpr int static_tree = LightTrees::static_tree, dynamic_tree = LightTrees::dynamic_tree;
    moving = bare;
    moving.exact = light_trees.exact;
    const auto is_sharp = [](const WholeLamp& lamp) { return lamp.sharp; };
    std::copy_if(light_trees.lamps.begin(), light_trees.lamps.end(), std::back_inserter(moving.lamps), is_sharp);
    moving.trees[dynamic_tree] = light_trees.trees[dynamic_tree];
    occluded = light_trees;
    occluded.exact.clear();
    std::erase_if(occluded.lamps, is_sharp);
    occluded.trees[dynamic_tree] = {};
    occluded.shadows = Shadows::hidden_by_dynamic;
    gained = lost = bare;
    gained.shadows = lost.shadows = Shadows::of_static;
    if (renews) {
        then_.assign(anchors.begin(), anchors.end());
        static_light = occluded;
        static_light.shadows = Shadows::of_static;
    } else {
        gained.trees[static_tree] = lasting.static_tree(more);
        lost.trees[static_tree] = lasting.static_tree(less);
    }
    return renews;
}

}  // namespace render2mpeg::renderer
