#include "app/experiments/knee.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace render2mpeg::app {

std::optional<std::size_t> knee_of(std::span<const Offer> offers, double least_range) {
    // Keep what is worth its cost, from the cheapest to the best.
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < offers.size(); ++i)
        if (offers[i].cost > 0 && std::isfinite(offers[i].cost) && std::isfinite(offers[i].quality)) order.push_back(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return offers[a].cost < offers[b].cost; });
    std::vector<std::size_t> worth;
    for (const std::size_t i : order)
        if (worth.empty() || offers[i].quality > offers[worth.back()].quality) worth.push_back(i);
    if (order.size() < 3) return std::nullopt;

    const Offer& cheapest = offers[worth.front()];
    const double height = offers[worth.back()].quality - cheapest.quality;
    const double width = std::log(offers[order.back()].cost / cheapest.cost);
    if (!(height >= least_range) || !(width > 0)) return std::nullopt;
    std::optional<std::size_t> knee;
    double farthest = least_height;
    for (const std::size_t i : worth) {
        const double above =
            (offers[i].quality - cheapest.quality) / height - std::log(offers[i].cost / cheapest.cost) / width;
        if (above <= farthest) continue;
        farthest = above;
        knee = i;
    }
    return knee;
}

}  // namespace render2mpeg::app
