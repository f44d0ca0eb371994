#pragma once
// How an input of a material changes with the angle that it is seen at.
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

namespace render2mpeg::scene {

/// Inputs that may.
enum class AngledInput { base_color, emission, gloss, metallic, roughness, alpha, transmission, coat };

/// An input between the material's own value and another one.
struct AngleCurve {
    AngledInput input = AngledInput::base_color;
    glm::vec3 other{0};  ///< as the material's value; numbers are in x
    /// How much of `other` there is, 0..1, by equal steps of the root of the cosine to the normal from 0 to 1; 2 or
    /// more.
    std::vector<glm::vec3> share{glm::vec3(0), glm::vec3(0)};

    glm::vec3 share_at(float cosine) const {
        const auto last = static_cast<float>(share.size() - 1);
        const float at = last * std::sqrt(std::clamp(cosine, 0.0f, 1.0f));
        const auto k = std::min(static_cast<std::size_t>(at), share.size() - 2);
        return glm::mix(share[k], share[k + 1], at - static_cast<float>(k));
    }

    /// Seen under even light: the mean over cosines, weighted by them.
    glm::vec3 mean_share() const {
        constexpr int steps = 256;
        glm::vec3 sum{0};
        for (int k = 0; k < steps; ++k) {
            const float cosine = (static_cast<float>(k) + 0.5f) / steps;
            sum += (2.0f * cosine / steps) * share_at(cosine);
        }
        return sum;
    }
};

}  // namespace render2mpeg::scene
