#pragma once
// How many stratified samples a place needs: one law for pixels, exposures and lamps.
#include <cmath>

namespace render2mpeg::renderer {

/// Standard error of the mean of n stratified samples, over that of one sample: only the strata that an edge crosses
/// err, about sqrt(n) of n.
inline float strata_error(float n) {
    return 1.0f / (std::sqrt(n) * std::sqrt(std::sqrt(n)));
}

}  // namespace render2mpeg::renderer
