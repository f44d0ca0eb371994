#pragma once
// Paths from the eye through the area of a pixel to the lights, and what a pixel's batches of them say.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "renderer/base/stream.h"
#include "renderer/paths/light_paths.h"
#include "renderer/surface/gather_point.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/view/eye_path.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// A pixel whose truth is wanted.
struct TruthRequest {
    glm::ivec2 place{0};
    std::span<const GatherPoint> points;  ///< its gather points; none: nothing there wants light
    float luminance = 0;                  ///< about, >= 0: errors count by it
    int samples = 1;                      ///< eye samples of the pixel
    glm::vec3 known{0};                   ///< radiance of it that paths do not find: caustics, light of the air
};

/// Sums over paths.
struct PathSums {
    glm::dvec3 at_points{0}, whole{0};
    double squares = 0;  ///< of luminances of `whole`
};

/// Paths of any pixel of the posed instant. Any thread.
class PixelPaths {
  public:
    PixelPaths(const PosedScene& posed_scene, const SeeSettings& see, const Plan& plan)
        : posed_scene_(posed_scene), eye_(posed_scene, see, plan), paths_(posed_scene, plan) {}

    /// Radiance of the pixel's own eye samples without gathering, but for lobe rays.
    glm::vec3 shown_by_pattern(const TruthRequest& request) const;

    /// Paths 0 to `count` - 1 of a batch, from the gather points and over the whole pixel; finite.
    PathSums follow(const TruthRequest& request, const Stream& batch, std::uint64_t count) const;

  private:
    void look(glm::vec2 position, float spacing, EyeSample& sample) const;

    const PosedScene& posed_scene_;
    EyePaths eye_;
    LightPaths paths_;
};

/// Independent parts of an estimate, whose spread tells its error. chosen: 16, by which it is known to a fifth.
inline constexpr std::uint64_t truth_batches = 16;

/// Numbers of one of a pixel's batches; batch `truth_batches` is the pilot's.
inline Stream numbers_of_batch(std::uint64_t seed, std::int64_t frame, glm::ivec2 place, std::uint64_t batch) {
    return Stream(Purpose::true_paths, {place, frame, seed}).at(batch);
}

/// The mean of two independent halves of equal weight.
struct Estimate {
    std::array<glm::dvec3, 2> halves{glm::dvec3(0), glm::dvec3(0)};  ///< radiance
    double variance = 0;                                             ///< of the whole mean's luminance

    glm::dvec3 mean() const { return 0.5 * (halves[0] + halves[1]); }
    double luminance() const { return 0.5 * (luminance_of(0) + luminance_of(1)); }
    double luminance_of(std::size_t half) const;
};

/// Estimate by the means of batches, plus a given term.
Estimate estimate_of(const std::array<glm::dvec3, truth_batches>& means, glm::dvec3 added);

}  // namespace render2mpeg::renderer
