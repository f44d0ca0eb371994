#pragma once
// How much of what coding hides light may use, by picture type.
#include <cstdint>

/// What share of the errors that coding hides lighting may use.
namespace render2mpeg::perceptual {

/// k: the share of what coding hides that gathering light may use so that a film loses 0.05 dB of PSNR-Y by it at most
/// against the truth: half of what `--loss` gives to all parts. Beyond it errors of lighting add to those of coding; at
/// 1 the eye's model alone would find them. In (0, 1]; of pictures that nothing is predicted from. fit:
/// docs/measurements.md#tolerance-fraction. The same for every quantiser: a power of it gains nothing.
inline constexpr float default_tolerance_fraction = 0.5f;

/// What part of k a picture's light may use that `followers` >= 0 later ones depend on, directly or not: errors that
/// coding keeps are handed on to all of them. 1 where none does (B pictures, a group's last P picture, films of I
/// pictures alone), less in I pictures than in P pictures, which take over most of their own. In (0, 1].
float propagation_factor(bool intra, std::int64_t followers);

}  // namespace render2mpeg::perceptual
