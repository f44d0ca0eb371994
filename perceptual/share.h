#pragma once

namespace render2mpeg::perceptual {

/// k: the share of what coding with the scale qs hides (BlockCoding::scale) that lighting may use so that the film
/// keeps its quality: 0.1 dB at most are lost. Beyond it errors of lighting add to those of coding; at 1 the eye's
/// model alone would find them. In (0, 1].
float default_share(float scale);

}  // namespace render2mpeg::perceptual
