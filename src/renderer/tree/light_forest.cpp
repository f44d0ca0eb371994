#include "renderer/tree/light_forest.h"

#include <algorithm>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/tree/light_clusters.h"

namespace render2mpeg::renderer {
namespace {

/// How much more an updated tree may cost than one planned for the instant before it is. chosen: 1.5, which a lamp on
/// its way through a room does not reach (cuts of at most 1.1 times the fresh tree's; test), and things that change
/// places do.
constexpr double most_cost = 1.5;

/// What every light counts with at least, of their mean, when a tree is planned anew: it may be lit later.
constexpr float least_planned = 0.01f;

/// What is punctual: a true point or beam, not a sample of something larger.
bool is_punctual(const LightPoint& p) {
    return p.kind != LightPointKind::oriented && p.disc2 == 0.0f;
}

using Families = std::array<std::vector<LightPoint>, LightForest::direct_trees>;

void add_exact(const LightPoint& p, std::uint64_t seed, std::vector<ExactLight>& exact) {
    const LightPoint one[] = {p};
    const LightTree tree = build_light_tree(family_of(p.kind), one, seed);
    if (!tree.empty())
        exact.push_back({tree.family, tree.lights.front(), tree.spots.empty() ? Spot{} : tree.spots.front()});
}

std::uint64_t seed_of(int tree, std::uint64_t seed) {
    return LightForest::is_direct(tree) ? seed : seed + 1;
}

/// All lights of a plan as they lie now, to plan by; those that are absent lie with their neighbours in the tree.
std::vector<LightPoint> with_absent(const TreePlan& plan, std::span<const LightPoint> now) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_id;
    glm::dvec3 sum(0);
    for (std::uint32_t i = 0; i < now.size(); ++i) {
        if (!is_finite(now[i])) continue;
        by_id.emplace_back(now[i].id, i);
        sum += glm::dvec3(now[i].intensity);
    }
    std::vector<LightPoint> all;
    if (by_id.empty()) return all;
    std::sort(by_id.begin(), by_id.end());
    const auto least = glm::vec3(sum * (least_planned / static_cast<double>(plan.lights()))) + glm::vec3(1e-20f);
    const LightPoint* last = &now[by_id.front().second];
    all.reserve(plan.lights());
    for (const std::uint32_t id : *plan.ids) {
        const auto found = std::lower_bound(by_id.begin(), by_id.end(), std::pair{id, 0u});
        const bool there = found != by_id.end() && found->first == id;
        if (there) last = &now[found->second];
        LightPoint p = *last;
        p.id = id;
        p.intensity = (there ? p.intensity : glm::vec3(0)) + least;
        all.push_back(p);
    }
    return all;
}

}  // namespace

LightForest plant(std::span<const LightPoint> direct, std::span<const LightPoint> vpls, std::uint64_t seed) {
    LightForest forest;
    const auto punctual = static_cast<std::size_t>(std::count_if(direct.begin(), direct.end(), is_punctual));
    Families families;
    for (const LightPoint& p : direct) {
        if (is_punctual(p) && punctual <= most_exact_lights)
            add_exact(p, seed, forest.exact);
        else
            families[static_cast<std::size_t>(family_of(p.kind))].push_back(p);
    }
    for (int f = 0; f < LightForest::direct_trees; ++f)
        forest.trees[f] = build_light_tree(static_cast<LightFamily>(f), families[f], seed_of(f, seed));
    forest.trees[LightForest::still_tree] =
        build_light_tree(LightFamily::oriented, vpls, seed_of(LightForest::still_tree, seed));
    return forest;
}

LastingForest::LastingForest(const LitPoints& usual, std::uint64_t seed) : seed_(seed) {
    const auto punctual = std::count_if(usual.direct.begin(), usual.direct.end(), is_punctual);
    Families families;
    for (const LightPoint& p : usual.direct) {
        if (is_punctual(p) && static_cast<std::size_t>(punctual) <= most_exact_lights)
            exact_.push_back(p.id);
        else
            families[static_cast<std::size_t>(family_of(p.kind))].push_back(p);
    }
    std::sort(exact_.begin(), exact_.end());
    for (int t = 0; t < LightForest::tree_count; ++t) {
        const bool direct = LightForest::is_direct(t);
        const auto points = direct                         ? std::span<const LightPoint>(families[t])
                            : t == LightForest::still_tree ? usual.still
                                                           : usual.moving;
        const LightFamily family = direct ? static_cast<LightFamily>(t) : LightFamily::oriented;
        plans_[t] = plan_of(build_lasting_tree(family, points, seed_of(t, seed)));
    }
}

LightForest LastingForest::at(const LitPoints& now, bool may_replan) {
    LightForest forest;
    Families families;
    for (const LightPoint& p : now.direct) {
        if (std::binary_search(exact_.begin(), exact_.end(), p.id))
            add_exact(p, seed_, forest.exact);
        else
            families[static_cast<std::size_t>(family_of(p.kind))].push_back(p);
    }
    for (int t = 0; t < LightForest::tree_count; ++t) {
        const auto points = LightForest::is_direct(t)      ? std::span<const LightPoint>(families[t])
                            : t == LightForest::still_tree ? now.still
                                                           : now.moving;
        LightTree& tree = forest.trees[t];
        tree = grow_light_tree(plans_[t], points, seed_of(t, seed_));
        if (tree.empty()) continue;
        // A dark tree would be asked about for nothing.
        if (!(core::luminance(tree.intensity(tree.root)) > 0.0f)) {
            tree = {};
            tree.family = plans_[t].family;
            continue;
        }
        if (!may_replan) continue;
        TreePlan other = plan_of(build_lasting_tree(tree.family, with_absent(plans_[t], points), seed_of(t, seed_)));
        LightTree fresh = grow_light_tree(other, points, seed_of(t, seed_));
        if (cost_of(tree) <= most_cost * cost_of(fresh)) continue;
        tree = std::move(fresh);
        plans_[t] = std::move(other);
        ++replanned_;
    }
    return forest;
}

LightTree LastingForest::still_tree(std::span<const LightPoint> anchors) const {
    constexpr int t = LightForest::still_tree;
    LightTree tree = grow_light_tree(plans_[t], anchors, seed_of(t, seed_));
    if (!tree.empty() && !(core::luminance(tree.intensity(tree.root)) > 0.0f)) {
        tree = {};
        tree.family = plans_[t].family;
    }
    return tree;
}

std::size_t LastingForest::bytes() const {
    std::size_t sum = exact_.capacity() * sizeof(std::uint32_t);
    for (const TreePlan& plan : plans_) sum += plan.bytes();
    return sum;
}

}  // namespace render2mpeg::renderer
