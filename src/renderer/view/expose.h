#pragma once
// Exposure: which surface points each pixel shows while the shutter is open, through all of the lens.
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// Counts of an exposure, for the statistics.
struct ExposureCounts {
    std::uint64_t rays = 0;     ///< of exposed samples, and on through layers; mirrors included
    std::uint64_t pixels = 0;   ///< that are blurred
    std::uint64_t samples = 0;  ///< of all pixels that were sampled
    std::uint64_t points = 0;   ///< gather points that the frame's middle does not show
};

/// The frame with its exposure: samples the pixels that the open shutter or the aperture of the posed snapshot's lens
/// may blur, and adds gather points that only they show. Pixels in which nothing is blurred stay as they are; so does
/// the frame where nothing moves and the camera is a pinhole. Does not depend on the number of threads.
Frame expose(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan,
             const ExposureSamples& samples, Frame seen, ExposureCounts& counts);

}  // namespace render2mpeg::renderer
