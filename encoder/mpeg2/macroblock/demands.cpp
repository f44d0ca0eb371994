#include "encoder/mpeg2/macroblock/demands.h"

#include <algorithm>

#include "encoder/mpeg2/macroblock/dependency.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// The entry for a macroblock that may lie in the padding.
template <class T>
T nearest(const core::Plane<T>& map, int column, int row) {
    return map.at(std::min(column, map.width() - 1), std::min(row, map.height() - 1));
}

}  // namespace

Demands demands_from(const Hints& hints, int columns, int rows) {
    Demands demands;
    if (hints.onward) demands.quantiser_factors = quantiser_factors(*hints.onward, columns, rows);
    if (hints.quantiser_factors && !hints.onward) demands.quantiser_factors = core::Plane<float>(columns, rows, 1.0f);
    if (hints.forced) demands.forced = core::Plane<Force>(columns, rows, Force::none);
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            if (hints.quantiser_factors)
                demands.quantiser_factors.at(column, row) *= nearest(*hints.quantiser_factors, column, row);
            if (hints.forced) demands.forced.at(column, row) = nearest(*hints.forced, column, row);
        }
    return demands;
}

}  // namespace render2mpeg::encoder::mpeg2
