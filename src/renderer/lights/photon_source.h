#pragma once
// Where photons start.
#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/box.h"
#include "renderer/base/discrete_distribution.h"
#include "renderer/base/light_point.h"
#include "renderer/surface/light_ray.h"

namespace render2mpeg::renderer {

/// The box about a thing, as it lies in the world.
using BoxCorners = std::array<glm::vec3, 8>;

/// View of a box from a light point: a rectangle across `towards`, or all directions if it is too near.
struct SeenBox {
    glm::vec3 towards{0}, right{0}, up{0};
    glm::vec3 middle{0};
    glm::vec2 half{0};
    bool all_around = false;

    float area() const { return 4.0f * half.x * half.y; }
    /// A place of the rectangle by two numbers in [0, 1).
    glm::vec3 at(glm::vec2 u) const {
        const glm::vec2 q = (2.0f * u - 1.0f) * half;
        return middle + q.x * right + q.y * up;
    }
};
SeenBox seen_from(const LightPoint& light, const BoxCorners& corners);

/// A photon that leaves a light.
struct Photon : LightRay {
    float range = 0;    ///< LightPoint::range, on the first flight
    glm::vec3 flux{0};  ///< power over the density of its choice: the mean over photons is the lights' power
};

/// Chooses photons mostly in proportion to the power of light points, some of them alike for all, so that a dim lamp in
/// the room that is seen has its photons beside the sun outside: cosine about oriented ones, the whole sphere or cone
/// about punctual ones, and the rectangle that the scene's box throws as shadow for directional ones.
class PhotonSource {
  public:
    /// `planned`: the same lights, whose power they are chosen by; empty: their own. Where lamps flicker, their photons
    /// then go the same ways.
    PhotonSource(std::span<const LightPoint> lights, const core::Box& box, std::span<const LightPoint> planned = {});

    bool empty() const { return !(choice_.total() > 0.0); }
    /// Power of a light, over the luminance of its intensity.
    double relative_power(std::size_t light) const { return power_[light]; }

    /// From three numbers in [0, 1): which light, and two for where on its beam (directional) or which direction.
    Photon emit(glm::vec3 numbers) const;

  private:
    double power_of(const LightPoint& light) const;

    std::span<const LightPoint> lights_;
    BoxCorners box_;
    float reach_;                ///< directional light comes from so far
    std::vector<double> power_;  ///< of each light of luminance 1
    DiscreteDistribution choice_;
};

}  // namespace render2mpeg::renderer
