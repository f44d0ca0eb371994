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
struct ViewSample {
    std::vector<glm::vec3> places;
    float luminance = 0;
};

/// View of this camera at the posed instant.
ViewSample sample_view(const PosedScene& posed_scene, const Plan& plan, const scene::Camera& camera);

/// Places so near a lamp or shining object that they far outshine the rest: its shade, the wall behind it. Gather rays
/// would meet such spots rarely, and find them hundreds of times as bright as all else. A share of what surfaces there
/// reflect becomes light points (near_light); rays over hemispheres miss that share.
class NearField {
  public:
    NearField() = default;
    /// Of lights of the instant. The share begins where one makes a white surface as bright as half of what is seen,
    /// but no farther off than half of the way to it. Sources that would light half of it far more than it is lit are
    /// hidden from it, and have no near field; nor have objects that are wider than theirs.
    NearField(std::span<const LightPoint> lights, const ViewSample& view);

    /// Near-field light of a place.
    struct Part {
        float share = 0;       ///< of what a surface reflects, the largest: e of docs/model/gathering.md, eq. 6
        float irradiance = 0;  ///< about, of that source, luminance
    };

    bool empty() const { return spheres_.empty(); }
    Part at(glm::vec3 place) const;
    float share(glm::vec3 place) const { return at(place).share; }
    bool operator==(const NearField&) const = default;
    /// Others have other keys, but for one in 2^32.
    std::uint32_t key() const;

  private:
    struct Sphere {
        glm::vec3 centre{0};
        float inverse2 = 0;   ///< 1 / r^2
        float intensity = 0;  ///< luminance
        bool operator==(const Sphere&) const = default;
    };
    std::vector<Sphere> spheres_;
};

/// The near field's share of what surfaces reflect of all light of these lights, where photons meet them. `average`:
/// LightPoints::average.
std::vector<LightPoint> near_light(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                                   std::span<const LightPoint> average, const NearField& near_field,
                                   std::uint64_t& rays);

}  // namespace render2mpeg::renderer
