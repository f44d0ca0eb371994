#include "renderer/view/mattes.h"

#include <algorithm>

namespace render2mpeg::renderer {
namespace {

std::span<const SeenMatte> of_pixel(const std::vector<SeenMatte>& mattes, std::uint16_t pixel) {
    const auto [first, end] = std::equal_range(mattes.begin(), mattes.end(), SeenMatte{pixel, {}},
                                               [](const auto& a, const auto& b) { return a.pixel < b.pixel; });
    return {first, end};
}

}  // namespace

void add_mattes(std::span<const core::Matte> sample, std::uint16_t pixel, float share, std::vector<SeenMatte>& mattes) {
    for (const core::Matte& part : sample) {
        auto match = mattes.rbegin();
        while (match != mattes.rend() && match->pixel == pixel &&
               !(match->matte.object == part.object && match->matte.material == part.material))
            ++match;
        if (match == mattes.rend() || match->pixel != pixel)
            mattes.push_back({pixel, {part.object, part.material, share * part.share}});
        else
            match->matte.share += share * part.share;
    }
}

void forget_mattes(std::uint16_t pixel, std::vector<SeenMatte>& mattes) {
    while (!mattes.empty() && mattes.back().pixel == pixel) mattes.pop_back();
}

core::Mattes mattes_of(const Frame& seen) {
    core::Mattes all;
    if (seen.mattes.empty()) return all;
    all.width = seen.visible.width();
    all.height = seen.visible.height();
    for (int y = 0; y < all.height; ++y)
        for (int x = 0; x < all.width; ++x) {
            const auto tile = static_cast<std::size_t>(y / tile_size * seen.tiles_across() + x / tile_size);
            const bool exposed = seen.exposure && seen.exposure->exposed.at(x, y) != 0;
            const auto& mattes = exposed ? seen.exposure->mattes[tile] : seen.mattes[tile];
            all.starts.push_back(all.parts.size());
            for (const SeenMatte& part :
                 of_pixel(mattes, static_cast<std::uint16_t>(y % tile_size * tile_size + x % tile_size)))
                all.parts.push_back(part.matte);
        }
    all.starts.push_back(all.parts.size());
    return all;
}

}  // namespace render2mpeg::renderer
