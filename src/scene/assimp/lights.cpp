#include "scene/assimp/lights.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::scene {
namespace {

bool attenuation_unsaid(const ClassicLight& l) {
    return l.constant == 0 && l.linear == 1 && l.quadratic == 0;
}

/// From colour to radiant intensity (point, spot) or irradiance (directional).
double physical_factor(const ClassicLight& l, double distance) {
    if (l.kind == LightKind::directional) return glm::pi<double>();
    const double squared = distance * distance;
    const double attenuation = attenuation_unsaid(l) ? 1 : l.constant + l.linear * distance + l.quadratic * squared;
    return glm::pi<double>() * core::divide_or(squared, attenuation, squared);
}

Light light_of_strength(const ClassicLight& classic, double factor) {
    Light light;
    light.kind = classic.kind;
    const glm::vec3 color = core::is_finite(classic.color) ? glm::max(classic.color, glm::vec3(0)) : glm::vec3(0);
    const float peak = std::max({color.r, color.g, color.b});
    const double strength = peak * factor;
    light.intensity = std::isfinite(static_cast<float>(strength)) ? static_cast<float>(std::max(strength, 0.0)) : 0;
    light.color = peak > 0 ? color / peak : glm::vec3(1);
    if (light.kind == LightKind::spot) {
        light.outer_cone = std::clamp(0.5f * classic.outer_angle, 0.01f, glm::half_pi<float>());
        light.inner_cone = std::clamp(0.5f * classic.inner_angle, 0.0f, 0.999f * light.outer_cone);
    }
    return light;
}

}  // namespace

Light physical_light(const ClassicLight& classic, double distance) {
    EXPECTS(distance > 0);
    return light_of_strength(classic, physical_factor(classic, distance));
}

Light blender_light(const ClassicLight& classic) {
    return light_of_strength(classic, classic.kind == LightKind::directional ? 1 : 1 / (4 * glm::pi<double>()));
}

bool falls_off_physically(const ClassicLight& l) {
    return l.kind == LightKind::directional || (l.constant == 0 && l.linear == 0 && l.quadratic > 0);
}

CameraLens lens_of(const ClassicCamera& classic) {
    CameraLens lens;
    // chosen: 4:3 where the file does not say the picture's shape, as the formats of that time meant; 60 degrees where
    // it does not say the angle.
    const double aspect = std::isfinite(classic.aspect) && classic.aspect > 0.01 ? classic.aspect : 4.0 / 3.0;
    if (std::isfinite(classic.aspect) && classic.aspect > 0.01) lens.aspect = static_cast<float>(classic.aspect);
    double horizontal = classic.horizontal_angle;
    if (!(horizontal > 0.02) || !(horizontal < 3.1)) horizontal = glm::pi<double>() / 3;
    lens.vertical_fov = static_cast<float>(2 * std::atan(std::tan(horizontal / 2) / aspect));
    if (classic.half_width > 0 && std::isfinite(classic.half_width)) {
        lens.perspective = false;
        lens.y_magnification = static_cast<float>(classic.half_width / aspect);
    }
    return lens;
}

}  // namespace render2mpeg::scene
