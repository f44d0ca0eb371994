#include "renderer/light_forest.h"

#include "core/color.h"

namespace render2mpeg::renderer {

LightForest plant(std::span<const LightPoint> direct, std::span<const LightPoint> vpls, std::uint64_t seed) {
    LightForest forest;
    // Count what is punctual: a true point or beam, not a sample of something larger.
    const auto is_punctual = [](const LightPoint& p) { return p.kind != LightPointKind::oriented && p.disc2 == 0.0f; };
    std::size_t punctual = 0;
    for (const LightPoint& p : direct) punctual += is_punctual(p) ? 1 : 0;

    std::array<std::vector<LightPoint>, LightForest::direct_trees> families;
    for (const LightPoint& p : direct) {
        if (is_punctual(p) && punctual <= most_exact_lights) {
            const LightPoint one[] = {p};
            LightTree tree = build_light_tree(family_of(p.kind), one, seed);
            if (!tree.empty()) forest.exact.push_back({tree.family, tree.lights.front()});
        } else {
            families[static_cast<std::size_t>(family_of(p.kind))].push_back(p);
        }
    }
    for (int f = 0; f < LightForest::direct_trees; ++f)
        forest.trees[f] = build_light_tree(static_cast<LightFamily>(f), families[f], seed);
    forest.trees[LightForest::direct_trees] = build_light_tree(LightFamily::oriented, vpls, seed + 1);
    return forest;
}

}  // namespace render2mpeg::renderer
