#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "renderer/surface/posed_scene.h"
#include "tests/reference/fog.h"
#include "tests/reference/lamps.h"
#include "tests/reference/surfaces.h"

namespace render2mpeg::reference {

/// A mean with what is known of its error, per channel.
struct Estimate {
    glm::dvec3 mean{0};
    glm::dvec3 error{0};  ///< standard error of the mean
};

/// How paths find lamps that have a size. Both give the same mean.
enum class Finding {
    by_chance,     ///< where they meet them
    by_connection  ///< at each surface that scatters a shadow ray goes to a point of them; meeting them counts for none
};

struct PathSettings {
    static constexpr int endless = 1 << 30;
    int bounces = endless;  ///< how often light may scatter before it reaches the surface that is seen; 0: direct alone
    int least_bounces = 0;  ///< what scattered less often is left out
    Finding finding = Finding::by_chance;
    /// Whether light counts that mirrors or bodies of glass throw onto the first surface that scatters
    /// (docs/model/caustics.md). Without it bodies pass the light of lamps straight.
    bool caustics = false;
};

/// Light along rays by plain path tracing: slow, and as near to the rendering equation as code can be. No clamp, no
/// cache, sums in double; roulette ends long paths without bias. It uses the renderer's rays, and the animation and its
/// snapshot; none of the renderer's materials, textures, lights or kernels. As in the renderer, suns are seen neither
/// by the eye nor in its mirrors. Fog dims all ways; of lamps without a size it scatters light, once, on the
/// eye's way, mirrors' among it. Glass is thin, or bounds bodies that are smooth and clear.
class PathTracer {
  public:
    explicit PathTracer(const renderer::PosedScene& posed_scene);

    /// Radiance that comes along a ray to its origin.
    Estimate radiance(glm::vec3 origin, glm::vec3 direction, const PathSettings& settings, std::uint64_t paths,
                      std::uint64_t seed) const;

    /// Radiance that a surface point scatters to its `outgoing`: no emission, mirror or transmission.
    Estimate scattered(const core::SurfaceAddress& address, glm::vec3 outgoing, const PathSettings& settings,
                       std::uint64_t paths, std::uint64_t seed) const;

    /// Radiance through the centres of a picture's pixels, row by row.
    std::vector<Estimate> picture(int width, int height, const PathSettings& settings, std::uint64_t paths_per_pixel,
                                  std::uint64_t seed) const;

  private:
    class Path;
    const renderer::PosedScene& posed_scene_;
    Surfaces surfaces_;
    Lamps lamps_;
    std::optional<Fog> fog_;
};

/// PathTracer::scattered of a point that the renderer found, by chance.
Estimate scattered_light(const renderer::PosedScene& posed_scene, const renderer::SurfacePoint& point, int bounces,
                         std::uint64_t paths, std::uint64_t seed, int least_bounces = 0);

}  // namespace render2mpeg::reference
