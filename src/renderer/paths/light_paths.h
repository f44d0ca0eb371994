#pragma once
// Follows paths from surfaces that the eye sees to the lights.
#include <cstdint>
#include <glm/glm.hpp>

#include "renderer/paths/light_sources.h"
#include "renderer/paths/path_numbers.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// All light scattered by surface points, by unbiased paths: the rendering equation of the product's own surfaces and
/// lights, without its light points (docs/model/truth.md). Any thread.
class LightPaths {
  public:
    LightPaths(const PosedScene& posed_scene, const Plan& plan);

    /// Radiance that the point scatters to its `outgoing`, along one path: right in the mean over `numbers`, finite.
    /// Excludes caustics on the point itself from mirrors and bodies of glass (caustics.h), but for light that a
    /// narrow lobe sees in mirrors.
    glm::vec3 scattered(const SurfacePoint& point, PathNumbers& numbers) const;
    /// The same; its rays leave the surface at `origin` (GatherPoint::elsewhere).
    glm::vec3 scattered(const SurfacePoint& point, glm::vec3 origin, PathNumbers& numbers) const;

  private:
    struct Path;
    enum class Event : std::uint8_t;
    glm::vec3 asked(const Path& path, PathNumbers& numbers) const;
    glm::vec3 answer(const Path& path, const LightSample& sample) const;
    bool leave(Path& path, PathNumbers& numbers) const;
    bool meet(Path& path, PathNumbers& numbers, glm::vec3& light) const;
    glm::vec3 escaped(const Path& path) const;
    glm::vec3 emitted(const Path& path, const SurfacePoint& met) const;
    Event go_on(Path& path, const SurfacePoint& met, float choice) const;

    const PosedScene& posed_scene_;
    bool sky_light_;
    float sky_in_panes_;  ///< luminance that the first point sees of the sky in panes at most; 0: none
    Bodies bodies_;       ///< to light that the first point sees straight
    LightSources lights_;
};

}  // namespace render2mpeg::renderer
