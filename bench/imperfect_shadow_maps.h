#pragma once

#include <cstdint>
#include <vector>

#include "bench/surface_cloud.h"
#include "renderer/base/light_point.h"
#include "renderer/geometry/ray_tracer.h"

namespace render2mpeg::bench {

/// Imperfect shadow maps [Ritschel2008]: for each light a small map of the distance to what it sees, drawn as discs of
/// few points of the surfaces. Paraboloids about a light's normal; orthographic where it is infinitely far. Holes are
/// closed by the discs' size, not by pull and push.
class ImperfectShadowMaps {
  public:
    /// Draws `splats` points of the cloud for each of the lights, others for each.
    ImperfectShadowMaps(const SurfaceCloud& cloud, const std::vector<renderer::LightPoint>& lights, int splats,
                        int side);

    /// Bit i: by the map of light `light`, something lies between ray i's origin and it.
    std::uint32_t occluded(const renderer::ShadowPacket& packet, std::size_t light) const;

  private:
    struct Seen {
        glm::vec2 at{0};     ///< of the map, texels
        float distance = 0;  ///< from the light; directional: along it
        float scale = 0;     ///< texels that one unit of length is there, about
        bool inside = false;
    };
    struct Frame {
        glm::vec3 origin{0}, x{0}, y{0}, z{0};
        bool directional = false;
    };
    Seen look(const Frame& frame, glm::vec3 place) const;
    void draw(const SurfaceCloud& cloud, std::size_t light, int splats);

    int side_;
    float radius_;       ///< of the ball about the scene
    float disc_radius_;  ///< of a splat, so that they cover the surfaces
    std::vector<Frame> frames_;
    std::vector<float> depths_;  ///< side x side for each light
};

}  // namespace render2mpeg::bench
