#pragma once
// Estimates the true radiance of pixels, with its error.
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/truth/pixel_paths.h"

namespace render2mpeg::renderer {

/// True radiance of a pixel. Half 0 of one is independent of half 1 of the other; alike halves are not.
struct PixelTruth {
    Estimate at_points;       ///< from its gather points, and from its own eye samples without them
    Estimate whole;           ///< over the whole area of the pixel
    std::uint64_t paths = 0;  ///< that each of them took
};

struct TruthSettings {
    float relative_error = 0.01f;         ///< wanted standard error of `whole`, over luminance
    std::uint64_t most_paths = 1u << 14;  ///< of a pixel and an estimate; 512 are the fewest in any case
    std::uint64_t seed = 1;
};

/// The truth of pixels of the posed instant, as `see` with these settings and this plan looks at it
/// (docs/model/truth.md). Unbiased: a pilot whose paths are thrown away decides how many a pixel gets. A function of
/// the arguments, for any number of threads; finite.
std::vector<PixelTruth> pixel_truth(const PosedScene& posed_scene, const SeeSettings& see, const Plan& plan,
                                    std::span<const TruthRequest> requests, const TruthSettings& settings = {});

}  // namespace render2mpeg::renderer
