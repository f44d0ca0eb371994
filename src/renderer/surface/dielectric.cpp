#include "renderer/surface/dielectric.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Cosine beyond the boundary; negative: all is reflected.
float cosine_beyond(float cosine, float index) {
    const float eta = 1.0f / index;
    const float sine = eta * core::sqrt_or_zero((1.0f - cosine) * (1.0f + cosine));
    if (sine >= 1.0f) return -1.0f;
    return std::sqrt((1.0f - sine) * (1.0f + sine));
}

/// Nothing is left of light that a medium takes faster, whatever the scene's scale.
constexpr float fastest = 1e30f;

}  // namespace

float dielectric_reflectance(float cosine, float index) {
    const float c = std::clamp(cosine, 0.0f, 1.0f), eta = 1.0f / index;
    const float beyond = cosine_beyond(c, index);
    if (beyond < 0.0f) return 1.0f;
    const float s = core::divide_or(eta * c - beyond, eta * c + beyond, 1.0f);
    const float p = core::divide_or(c - eta * beyond, c + eta * beyond, 1.0f);
    return std::min(0.5f * (s * s + p * p), 1.0f);
}

glm::vec3 refracted(glm::vec3 direction, glm::vec3 normal, float index) {
    const float cosine = std::clamp(-glm::dot(direction, normal), 0.0f, 1.0f), eta = 1.0f / index;
    const float beyond = cosine_beyond(cosine, index);
    if (beyond < 0.0f) return glm::vec3{0.0f};
    return core::normalize_or(eta * direction + (eta * cosine - beyond) * normal, direction);
}

glm::vec3 refracted_change(glm::vec3 direction, glm::vec3 direction_change, glm::vec3 normal, glm::vec3 normal_change,
                           float index) {
    const float eta = 1.0f / index, along = glm::dot(direction, normal);
    const float beyond = -cosine_beyond(std::clamp(-along, 0.0f, 1.0f), index);
    if (!(beyond < 0.0f)) return glm::vec3{0.0f};
    const float mu = eta * along - beyond;
    const float along_change = glm::dot(direction_change, normal) + glm::dot(direction, normal_change);
    const float mu_change = (eta - eta * eta * along / beyond) * along_change;
    const glm::vec3 change = eta * direction_change - (mu * normal_change + mu_change * normal);
    return core::is_finite(change) ? change : glm::vec3{0.0f};
}

glm::vec3 mirrored_change(glm::vec3 direction, glm::vec3 direction_change, glm::vec3 normal, glm::vec3 normal_change) {
    return direction_change -
           2.0f * (glm::dot(direction, normal) * normal_change +
                   (glm::dot(direction_change, normal) + glm::dot(direction, normal_change)) * normal);
}

float Medium::index_of(Band band) const {
    const float change = band == Band::red ? -dispersion : band == Band::blue ? dispersion : 0.0f;
    return std::max(index + change, 1.0f);
}

glm::vec3 Medium::passes(float distance) const {
    return glm::exp(-absorption * distance);
}

glm::vec3 passing_pane(const Medium& medium, float reflected, float cosine, float thickness) {
    const float within = cosine_beyond(std::clamp(cosine, 0.0f, 1.0f), medium.index);
    const glm::vec3 left = medium.passes(core::divide_or(thickness, within, 0.0f));
    glm::vec3 passing;
    for (int c = 0; c < 3; ++c) {
        const float around = reflected * left[c];
        passing[c] = (1.0f - reflected) * core::sqrt_or_zero(core::divide_or(left[c], 1.0f - around * around, 0.0f));
    }
    return passing;
}

Medium medium_of(const scene::Material& material) {
    Medium medium;
    medium.index = material.ior;
    medium.dispersion = 0.025f * material.dispersion * (material.ior - 1.0f);
    if (material.attenuation_distance > 0.0f)
        for (int c = 0; c < 3; ++c)
            medium.absorption[c] =
                std::min(-std::log(material.attenuation_color[c]) / material.attenuation_distance, fastest);
    return medium;
}

bool MediaStack::holds(std::uint32_t object) const {
    return std::any_of(entries_.begin(), entries_.begin() + count_, [&](const Entry& e) { return e.object == object; });
}

void MediaStack::begin_inside(std::uint32_t object, const Medium& medium) {
    if (!holds(object)) cross(object, medium, false);
}

float MediaStack::index_across(std::uint32_t object, const Medium& medium, bool back, Band band) const {
    const Medium* before = top();
    MediaStack after = *this;
    after.cross(object, medium, back);
    const Medium* beyond = after.top();
    if (before == beyond) return 1.0f;
    return (beyond != nullptr ? beyond->index_of(band) : 1.0f) / (before != nullptr ? before->index_of(band) : 1.0f);
}

void MediaStack::cross(std::uint32_t object, const Medium& medium, bool back) {
    if (!back) {
        if (count_ == static_cast<int>(entries_.size())) {
            std::move(entries_.begin() + 1, entries_.end(), entries_.begin());
            --count_;
        }
        entries_[static_cast<std::size_t>(count_++)] = {object, &medium};
        return;
    }
    for (int i = count_; i-- > 0;) {
        if (entries_[static_cast<std::size_t>(i)].object != object) continue;
        std::move(entries_.begin() + i + 1, entries_.begin() + count_, entries_.begin() + i);
        --count_;
        return;
    }
}

}  // namespace render2mpeg::renderer
