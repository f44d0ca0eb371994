#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "record_gradients_light.h"

namespace render2mpeg::bench {

/// A record near a place that asks.
struct Near {
    const SlopedLight* record;
    glm::vec2 offset;            ///< from that place on the picture, in quarters of the lattice's step
    float closeness;             ///< weight
    glm::vec3 position, normal;  ///< of the record, world; shading normal
};

/// The place that asks.
struct Place {
    glm::vec3 position, normal;
    glm::vec3 reflects;  ///< pixel's colour by irradiance over pi
    float step;          ///< the lattice's step at the place, world
};

/// What records say of a place.
struct Guess {
    bool found = false;
    glm::vec3 value{0};
    float off = 0;         ///< what they disagree by, luminance
    bool level = false;    ///< by a mean, where no plane is; `off` has the product's further doubts
    bool instead = false;  ///< by the other method of two
};

enum class Method : std::uint8_t {
    mean,
    plane,
    turned,
    halfway,
    gradients,
    stretched,
    hermite,
    seconded,
    plane_or_mean,
    plane_or_gradients,
    halfway_or_gradients
};
inline constexpr int method_count = 11;
inline constexpr std::array<std::string_view, method_count> method_names = {
    "mean",
    "plane",
    "plane of values turned to the place's normal",
    "plane of values taken halfway by gradients",
    "gradients, weighted by clearance",
    "the same, stretched along coherent light",
    "plane with gradients as observations",
    "plane, doubted by what gradients say too",
    "plane, else mean",
    "plane, else gradients",
    "halfway plane, else gradients",
};

inline bool says_else(Method method) {
    return method >= Method::plane_or_mean;
}

/// What a record says of the place: its light, changed by its gradients for shares of the way and of the turn to there.
glm::vec3 told(const Near& near, const Place& place, float way, float turn);

/// `least`: records that means and gradients need.
Guess guess(Method method, const Place& place, const std::vector<Near>& near, int least);

}  // namespace render2mpeg::bench
