#pragma once
// Looks along narrow glossy lobes.
#include <cstdint>
#include <glm/glm.hpp>

#include "renderer/surface/posed_scene.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// The sky, and what surfaces scatter, as narrow lobes reflect it (Bsdf::has_narrow_lobe): by rays along their visible
/// normals [Heitz2018]. The lobe's radiance is its albedo times the mean of what these rays meet, by their weights:
/// exact under an even sky. Light points would stand too far apart there (docs/model/visibility.md).
class LobeRays {
  public:
    LobeRays(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan);

    /// Whether there are any.
    bool trace_rays() const { return traces_; }

    /// Marks those points of a tile, not marked yet, whose lobes have rays, and adds what these bring to `emitted` and
    /// to the part of it that it belongs to. Returns the rays. Reads and writes nothing of other tiles.
    std::uint64_t light(std::size_t tile, Seen& seen) const;

    /// Radiance that a point with a narrow lobe reflects; adds the rays.
    glm::vec3 radiance(const GatherPoint& p, std::uint64_t& rays) const;

  private:
    struct Sums;
    void trace(const GatherPoint& p, std::uint32_t first, glm::uvec2 scramble, Sums& sums) const;
    glm::vec3 radiance_along(RayQuery ray, Hit hit, float solid_angle, std::uint64_t& rays) const;
    glm::vec3 sky(glm::vec3 direction, float solid_angle) const;
    glm::uvec2 scramble_of(const SurfacePoint& p) const;

    const PosedScene& posed_scene_;
    std::function<glm::vec3(const SurfacePoint&, int& rays)> irradiance_;
    image::SkyImportance sky_importance_;
    bool traces_;
    float brightest_;     ///< luminance of the sky times `sky_importance_`; light trees have what is beyond
    float pixel_extent_;  ///< of a pixel at distance 1
};

}  // namespace render2mpeg::renderer
