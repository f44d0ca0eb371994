#pragma once

#include "core/picture.h"
#include "core/threshold_map.h"

namespace render2mpeg::perceptual {

/// The thresholds of a picture by luminance and contrast masking (docs/model.md, "Masking"), from its unrounded luma,
/// or from `y` where it has none. Blocks that hang over the right or lower side are filled up by repeating the edge.
/// The luma is finite. A picture without pixels has no blocks.
core::ThresholdMap mask(const core::Picture& picture);

}  // namespace render2mpeg::perceptual
