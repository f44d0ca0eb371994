#include "encoder/mpeg2/macroblock/overrides.h"

#include <algorithm>
#include <cmath>

#include "encoder/mpeg2/macroblock/macroblock_tree.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// The entry for a macroblock that may lie in the padding.
template <class T>
T nearest(const core::Plane<T>& map, int column, int row) {
    return map.at(std::min(column, map.width() - 1), std::min(row, map.height() - 1));
}

/// Quantisers grow with this power of the error that contrast hides, from what it usually hides on. The place does not
/// depend on the picture: in a film of several shots the busier ones are coarser. chosen: docs/measurements.md#codecs
constexpr float hiding_power = 0.5f, usually_hidden = 0.3f;

}  // namespace

MacroblockOverrides overrides_from(const Hints& hints, int columns, int rows, double quantiser) {
    MacroblockOverrides overrides;
    if (hints.onward)
        overrides.quantiser_factors = quantiser_factors(*hints.onward, hints.innovation, columns, rows, quantiser);
    if ((hints.quantiser_factors || hints.hidden) && !hints.onward)
        overrides.quantiser_factors = core::Plane<float>(columns, rows, 1.0f);
    if (hints.forced) overrides.forced = core::Plane<Force>(columns, rows, Force::none);
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            if (hints.quantiser_factors)
                overrides.quantiser_factors.at(column, row) *= nearest(*hints.quantiser_factors, column, row);
            if (hints.hidden)
                overrides.quantiser_factors.at(column, row) *=
                    std::exp2(hiding_power * (nearest(*hints.hidden, column, row) - usually_hidden));
            if (hints.forced) overrides.forced.at(column, row) = nearest(*hints.forced, column, row);
        }
    return overrides;
}

}  // namespace render2mpeg::encoder::mpeg2
