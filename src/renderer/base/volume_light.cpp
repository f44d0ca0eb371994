#include "renderer/base/volume_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/base/fog_medium.h"

namespace render2mpeg::renderer {
namespace {

constexpr float inverse_sphere = 0.25f * std::numbers::inv_pi_v<float>;

/// Irradiance across the beam by intensity, and where it comes from.
struct Beam {
    float falloff;
    glm::vec3 direction;  ///< where the light goes, unit
};

Beam beam_of(const VolumeMedium& medium, const LightPoint& lamp, glm::vec3 place) {
    if (lamp.is_far()) return {1.0f, lamp.normal};
    const glm::vec3 way = place - lamp.position;
    const float distance2 = glm::dot(way, way);
    // Within half a voxel, or its own disc, of a lamp nothing is known.
    const float near2 = std::max({0.25f * medium.voxel() * medium.voxel(), lamp.disc2, 1e-30f});
    const glm::vec3 direction = way / std::sqrt(std::max(distance2, 1e-30f));
    return {lamp.emitted(direction, distance2) / std::max(distance2, near2), direction};
}

}  // namespace

glm::vec3 VolumeLight::scattered(const VolumeMedium& medium, glm::vec3 index_place, glm::vec3 direction) const {
    glm::vec3 sum(0);
    if (!ambient.empty()) sum += interpolated(ambient, index_place / float(ambient_spacing));
    if (lamps.empty()) return sum;
    const glm::vec3 place = medium.to_world(index_place);
    const float g = medium.anisotropy();
    const glm::vec3 albedo = g > 0.0f ? medium.albedo(index_place) : glm::vec3(0);
    for (const VolumeLamp& lamp : lamps) {
        const LampWay way = interpolated(lamp.ways, index_place / float(lamp_spacing));
        if (way.passes == glm::vec3(0)) continue;
        const Beam beam = beam_of(medium, lamp.light, place);
        const glm::vec3 left = glm::exp(-way.depth);
        glm::vec3 light = phase(g, glm::dot(beam.direction, direction)) * left;
        if (g > 0.0f) light += inverse_sphere * (glm::exp(-way.depth * (1.0f - g * albedo)) - left);
        sum += way.passes * lamp.light.intensity * (beam.falloff * light);
    }
    return sum;
}

glm::vec3 VolumeLight::lamps_mean(const VolumeMedium& medium, glm::vec3 index_place) const {
    glm::vec3 sum(0);
    const glm::vec3 place = medium.to_world(index_place), albedo = medium.albedo(index_place);
    for (const VolumeLamp& lamp : lamps) {
        const LampWay way = interpolated(lamp.ways, index_place / float(lamp_spacing));
        if (way.passes == glm::vec3(0)) continue;
        const float g = std::max(medium.anisotropy(), 0.0f);
        sum += way.passes * lamp.light.intensity * glm::exp(-way.depth * (1.0f - g * albedo)) *
               (inverse_sphere * beam_of(medium, lamp.light, place).falloff);
    }
    return sum;
}

}  // namespace render2mpeg::renderer
