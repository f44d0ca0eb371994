#include "renderer/cache/light_parts.h"

#include <algorithm>

#include "core/color.h"
#include "renderer/cut/movers.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {
namespace {

/// Anchors on what moves, as a share of all. Where there are more, what things change is most of the light, and
/// gathering that for every frame takes longer than gathering all of it afresh. chosen: 0.05; of the films that were
/// tried 0.002 and 0.007 gain, and 0.18 would lose (docs/fits/records.md).
constexpr double most_moving = 0.05;

/// Once all still anchors together have changed by this share of what they shone, those of now are taken.
/// chosen: 0.02, not tuned: 0.027 take a fifth of a cut's rays at 2 %, 0.0003 a fiftieth (bench_delta_cuts).
constexpr double most_changed = 0.02;

}  // namespace

bool LightParts::may_suit(const scene::Animation& film, const Plan& plan) {
    const scene::Traits traits = scene::traits_of(film);
    if (traits.lights_change || plan.runs(Pass::alpha) || plan.runs(Pass::glass) ||
        !(traits.objects_move || traits.objects_deform))
        return false;
    int movers = 0;
    for (const scene::Object& object : film.objects) {
        if (object.mobility == scene::Mobility::still) continue;
        if (film.materials[static_cast<std::size_t>(object.material)].emits()) return false;
        ++movers;
    }
    return movers <= GroupMovers::most;
}

bool LightParts::suit(const Scenery& scenery, const Plan& plan, std::size_t still_anchors, std::size_t moving_anchors) {
    return may_suit(scenery.animation(), plan) &&
           static_cast<double>(moving_anchors) <= most_moving * static_cast<double>(still_anchors + moving_anchors);
}

bool LightParts::take(const LightForest& forest, std::span<const LightPoint> anchors, const LastingForest& lasting) {
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

    LightForest bare;
    bare.direct_clamp = forest.direct_clamp;
    bare.indirect_clamp = forest.indirect_clamp;
    constexpr int still_tree = LightForest::still_tree, moving_tree = LightForest::moving_tree;
    moving = bare;
    moving.exact = forest.exact;
    moving.trees[moving_tree] = forest.trees[moving_tree];
    hidden = forest;
    hidden.exact.clear();
    hidden.trees[moving_tree] = {};
    hidden.shadows = Shadows::hidden_by_movers;
    gained = lost = bare;
    gained.shadows = lost.shadows = Shadows::of_what_is_still;
    if (renews) {
        then_.assign(anchors.begin(), anchors.end());
        still = hidden;
        still.shadows = Shadows::of_what_is_still;
    } else {
        gained.trees[still_tree] = lasting.still_tree(more);
        lost.trees[still_tree] = lasting.still_tree(less);
    }
    return renews;
}

}  // namespace render2mpeg::renderer
