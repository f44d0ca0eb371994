#pragma once
// The stopping rules of cuts.
namespace render2mpeg::renderer {

/// When a cut is fine enough; see CutRule.
enum class Stop {
    classic,  ///< no cluster's error bound exceeds the tolerance: bounds clusters, not pixels
    honest    ///< the estimated error of the whole pixel is below the tolerance
};

}  // namespace render2mpeg::renderer
