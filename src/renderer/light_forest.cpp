#include "renderer/light_forest.h"

#include <algorithm>

#include "core/color.h"
#include "renderer/light_clusters.h"

namespace render2mpeg::renderer {
namespace {

/// How much more an updated tree may cost than one built for the instant before it is replaced. chosen: 1.5, which a
/// lamp on its way through a room does not reach (cuts of at most 1.1 times the fresh tree's; test), and things that
/// change places do.
constexpr double most_cost = 1.5;

/// Larger trees are not compared: building takes as long as what it may save.
constexpr std::size_t most_compared = 1u << 16;

/// What is punctual: a true point or beam, not a sample of something larger.
bool is_punctual(const LightPoint& p) {
    return p.kind != LightPointKind::oriented && p.disc2 == 0.0f;
}

using Families = std::array<std::vector<LightPoint>, LightForest::direct_trees>;

void add_exact(const LightPoint& p, std::uint64_t seed, std::vector<ExactLight>& exact) {
    const LightPoint one[] = {p};
    const LightTree tree = build_light_tree(family_of(p.kind), one, seed);
    if (!tree.empty()) exact.push_back({tree.family, tree.lights.front()});
}

std::uint64_t seed_of(int tree, std::uint64_t seed) {
    return LightForest::is_direct(tree) ? seed : seed + 1;
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
        usual_[t] = build_lasting_tree(family, points, seed_of(t, seed));
    }
}

LightForest LastingForest::at(const LitPoints& now) {
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
        tree = usual_[t];
        update_light_tree(tree, points, seed_of(t, seed_));
        if (tree.empty()) continue;
        // A dark tree would be asked about for nothing.
        if (!(core::luminance(tree.intensity(tree.root)) > 0.0f)) {
            tree = {};
            tree.family = usual_[t].family;
            continue;
        }
        if (tree.lights.size() > most_compared) continue;
        LightTree fresh = build_light_tree(tree.family, points, seed_of(t, seed_));
        if (cost_of(tree) <= most_cost * cost_of(fresh)) continue;
        tree = std::move(fresh);
        ++rebuilt_;
    }
    return forest;
}

}  // namespace render2mpeg::renderer
