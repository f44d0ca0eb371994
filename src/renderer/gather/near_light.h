#pragma once
// Light that places near lamps send on, as light points.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/base/light_point.h"
#include "renderer/base/plan.h"
#include "renderer/surface/posed_scene.h"
#include "scene/model/camera.h"

namespace render2mpeg::renderer {

/// A few rays of the eye: where they meet surfaces, and the luminance that half of these exceed; 0: nothing is lit.
struct EyeLook {
    std::vector<glm::vec3> places;
    float luminance = 0;
};

/// What this camera sees at the posed instant.
EyeLook look_about(const PosedScene& posed_scene, const Plan& plan, const scene::Camera& camera, glm::ivec2 size);

/// Where lamps and shining objects are so near that surfaces are far brighter than elsewhere: in their shades, on the
/// wall behind them. Gather rays would meet such spots rarely, and find them hundreds of times as bright as all else.
/// A share of what surfaces there reflect becomes light points (near_light); rays over hemispheres miss that share.
class NearField {
  public:
    NearField() = default;
    /// Of lights of the instant. The share begins where one makes a white surface as bright as half of what is seen.
    /// Those that would light half of it far more than it is lit are hidden from it, and have no near field.
    NearField(std::span<const LightPoint> lights, const EyeLook& look);

    bool empty() const { return spheres_.empty(); }
    std::uint64_t sources() const { return spheres_.size(); }
    /// Of what a surface at this place reflects: 1 - d^2 / r^2 at distance d of the source that comes to the largest,
    /// where r^2 = I / irradiance; 0 beyond r.
    float share(glm::vec3 place) const;
    /// Irradiance that the share begins at, over 1 - share: about that at the place, luminance.
    float irradiance(float share) const { return irradiance_ / (1.0f - share); }

  private:
    struct Sphere {
        glm::vec3 centre{0};
        float inverse2 = 0;  ///< 1 / r^2
    };
    std::vector<Sphere> spheres_;
    float irradiance_ = 0;
};

/// The share of all light of these lights that surfaces in the near field reflect, where photons meet them. `average`:
/// LightPoints::average.
std::vector<LightPoint> near_light(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                                   std::span<const LightPoint> average, const NearField& near_field,
                                   std::uint64_t& rays);

}  // namespace render2mpeg::renderer
