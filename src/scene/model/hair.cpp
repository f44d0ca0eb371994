#include "scene/model/hair.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::scene {
namespace {

/// The polynomial of [Chiang2016, eq. 9].
float groom_factor(float b) {
    return ((((0.245f * b + 5.574f) * b - 10.73f) * b + 2.532f) * b - 0.215f) * b + 5.969f;
}

}  // namespace

glm::vec3 absorption_of(glm::vec3 color, float azimuthal_roughness) {
    const glm::vec3 root = glm::log(glm::clamp(color, 1e-5f, 1.0f)) / groom_factor(azimuthal_roughness);
    return root * root;
}

glm::vec3 color_of(glm::vec3 absorption, float azimuthal_roughness) {
    return glm::exp(-groom_factor(azimuthal_roughness) * glm::sqrt(glm::max(absorption, glm::vec3(0))));
}

glm::vec3 absorption_of_melanin(float melanin, float redness) {
    // As Cycles has them, so that grooms of Blender keep their colours.
    const glm::vec3 eumelanin(0.506f, 0.841f, 1.653f), pheomelanin(0.343f, 0.733f, 1.924f);
    return -std::log(std::max(1 - melanin, 1e-4f)) * glm::mix(eumelanin, pheomelanin, redness);
}

}  // namespace render2mpeg::scene
