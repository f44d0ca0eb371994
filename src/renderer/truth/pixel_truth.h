#pragma once
// Estimates the true radiance of pixels, with its error.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/surface/gather_point.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// A pixel whose truth is wanted.
struct TruthRequest {
    glm::ivec2 place{0};
    std::span<const GatherPoint> points;  ///< its gather points; none: nothing there wants light
    float luminance = 0;                  ///< about, >= 0: errors count by it
    int samples = 1;                      ///< eye samples of the pixel
    glm::vec3 known{0};                   ///< radiance of it that paths do not find: caustics
};

/// The mean of two independent halves of equal weight.
struct Estimate {
    std::array<glm::dvec3, 2> halves{glm::dvec3(0), glm::dvec3(0)};  ///< radiance
    double variance = 0;                                             ///< of the whole mean's luminance

    glm::dvec3 mean() const { return 0.5 * (halves[0] + halves[1]); }
    double luminance() const { return 0.5 * (luminance_of(0) + luminance_of(1)); }
    double luminance_of(std::size_t half) const;
};

/// What a pixel's radiance truly is. Half 0 of one is independent of half 1 of the other; alike halves are not.
struct PixelTruth {
    Estimate at_points;       ///< from its gather points, and what its own eye samples show without them
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
