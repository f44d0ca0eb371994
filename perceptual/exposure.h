#pragma once
// Chooses a film's exposure.
#include <span>

/// Measures the exposure of a film.
namespace render2mpeg::perceptual {

/// The exposure in EV that brings the middle of these luminances to mid grey (0.18), for a whole film from samples of
/// some of its frames. Scene-linear luminances in any order, which does not change the result by a bit. `surfaces`
/// decide; `sky`, what was seen past them, only where surfaces are next to nothing of what is lit: a view through a
/// window is not to darken the room. Samples that are black, or ten stops below the bright ones and so black on the
/// display, do not count, nor do non-finite ones; of the rest only the middle half does, so that a lamp does not
/// decide. 0 if nothing is left.
/// Its size is at most Display::max_exposure.
float auto_exposure(std::span<const float> surfaces, std::span<const float> sky = {});

}  // namespace render2mpeg::perceptual
