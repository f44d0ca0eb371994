#pragma once
// Light within fog, known at corners of a lattice.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/base/fog_medium.h"

namespace render2mpeg::renderer {

/// Mean radiance over all directions at corners of cells of a box; fog within it scatters that evenly to all sides.
/// Between corners light counts as linear, and as that of those corners that see so far towards a place: a wall parts
/// what lies before it from what lies behind [Majercik2019].
class LitFog {
  public:
    struct Corner {
        glm::vec3 lamps{0}, rest{0};  ///< lamps' light that nothing has scattered, and all other
        /// How far its rays go on the average, by octant: bit k is set where axis k rises.
        std::array<float, 8> clear{};
    };

    LitFog() = default;
    /// Black. The box from `low` to `high` in `cells` >= 1 along each axis.
    LitFog(glm::vec3 low, glm::vec3 high, glm::ivec3 cells);

    bool empty() const { return corners_.empty(); }
    /// Of a cell, the mean of its sides.
    float size() const { return (size_.x + size_.y + size_.z) / 3.0f; }
    /// Beyond this a corner lights nothing.
    float farthest() const { return 2.0f * glm::length(size_); }
    std::vector<Corner>& corners() { return corners_; }
    glm::vec3 place_of(std::size_t corner) const;
    static std::size_t octant(glm::vec3 direction);

    /// Calls visit(corner, weight) for those about a place in the box; their weights sum up to 1.
    template <class Visit>
    void about(glm::vec3 place, Visit visit) const;

    /// Calls visit(place, share) along a ray within the box and before `distance`: `share` of light at its origin is
    /// what fog there takes of it. All shares sum up to what fog takes there, and on the way to the sky beyond it.
    template <class Visit>
    void along(const FogMedium& fog, glm::vec3 from, glm::vec3 direction, float distance, Visit visit) const;

    glm::vec3 light_at(glm::vec3 place) const;
    glm::vec3 rest_at(glm::vec3 place) const;

  private:
    glm::ivec3 across() const { return cells_ + 1; }
    /// How much a corner counts that far off: all where it sees so far, next to nothing where others do.
    static float sight(float distance, float clear) {
        if (distance <= 0.75f * clear) return 1.0f;
        return distance < 1.25f * clear ? std::max(2.5f - 2.0f * distance / clear, 1e-3f) : 1e-3f;
    }
    bool clip(glm::vec3 from, glm::vec3 direction, float& begin, float& end) const;

    glm::vec3 low_{0};
    glm::vec3 size_{1};  ///< of cells
    glm::ivec3 cells_{0};
    std::vector<Corner> corners_;  ///< x fastest, then y
};

template <class Visit>
void LitFog::about(glm::vec3 place, Visit visit) const {
    const glm::vec3 at = glm::clamp((place - low_) / size_, glm::vec3(0), glm::vec3(cells_));
    const glm::ivec3 cell = glm::min(glm::ivec3(at), cells_ - 1);
    const glm::vec3 t = at - glm::vec3(cell);
    std::array<float, 8> weights{};
    std::array<std::size_t, 8> numbers{};
    float sum = 0;
    for (int c = 0; c < 8; ++c) {
        const glm::ivec3 turn(c & 1, c >> 1 & 1, c >> 2);
        const glm::ivec3 at_corner = cell + turn;
        const auto k = static_cast<std::size_t>(c);
        numbers[k] = static_cast<std::size_t>((at_corner.z * across().y + at_corner.y) * across().x + at_corner.x);
        const glm::vec3 off = size_ * (t - glm::vec3(turn)), w = glm::mix(1.0f - t, t, glm::vec3(turn));
        weights[k] = w.x * w.y * w.z * sight(glm::length(off), corners_[numbers[k]].clear[octant(off)]);
        sum += weights[k];
    }
    for (std::size_t k = 0; k < 8; ++k)
        if (weights[k] > 0.0f) visit(numbers[k], weights[k] / sum);
}

template <class Visit>
void LitFog::along(const FogMedium& fog, glm::vec3 from, glm::vec3 direction, float distance, Visit visit) const {
    // chosen: a step for each cell, eight at most: light is linear in it.
    constexpr float most_steps = 8;
    float begin = 0, end = distance;
    if (empty() || !clip(from, direction, begin, end)) return;
    const auto steps = static_cast<int>(std::clamp((end - begin) / size() + 0.5f, 1.0f, most_steps));
    const float step = (end - begin) / static_cast<float>(steps);
    float left = std::exp(-fog.optical_depth(from, direction, begin));
    for (int k = 0; k < steps && left > 1e-4f; ++k) {
        const float to = begin + static_cast<float>(k + 1) * step;
        const float then = std::min(std::exp(-fog.optical_depth(from, direction, to)), left);
        float middle = to - 0.5f * step;
        if (left - then > 0.1f * left)
            middle = std::clamp(fog.distance_at(from, direction, -std::log(0.5f * (left + then))), to - step, to);
        if (left > then) visit(from + middle * direction, left - then);
        left = then;
    }
    // Above the box layered fog is lit as at its border.
    const float beyond = std::isinf(distance) ? left - std::exp(-fog.depth_to_sky(from, direction)) : 0.0f;
    if (beyond > 1e-4f) visit(from + end * direction, beyond);
}

}  // namespace render2mpeg::renderer
