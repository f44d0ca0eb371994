#pragma once
// Finds the setting after which more cost buys least.
#include <cstddef>
#include <optional>
#include <span>

namespace render2mpeg::app {

/// One setting: what it costs and how good it is.
struct Offer {
    double cost = 0;     ///< > 0; others are passed over
    double quality = 0;  ///< finite; others are passed over
};

/// The offer after which more cost buys least: of those that are better than all cheaper ones, the one farthest above
/// the chord, both axes scaled to 1, cost by its logarithm [Satopaa2011]. The chord leads from the cheapest to the cost
/// of the dearest and the quality of the best: what costs more and is no better has bought nothing, which is what a
/// knee is looked for. None for fewer than three offers, where the best is not better than the cheapest by
/// `least_range`, or where none is above the chord by `least_height`.
std::optional<std::size_t> knee_of(std::span<const Offer> offers, double least_range);

/// chosen: 0.1 of the chord's height; times scatter by some per cent from run to run, which moves points along a
/// straight line by up to 0.03 where the sweep spans a factor of 30 (0.05..0.2).
inline constexpr double least_height = 0.1;

}  // namespace render2mpeg::app
