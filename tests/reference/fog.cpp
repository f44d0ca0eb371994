#include "tests/reference/fog.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace render2mpeg::reference {

Fog::Fog(const scene::Animation& film) : fog_(film.fog), low_(film.bounds_min), high_(film.bounds_max) {
    fog_.height -= static_cast<float>(film.origin.y);
}

double Fog::extinction(glm::dvec3 place) const {
    const double falloff = fog_.falloff;
    return 3.0 / fog_.visibility * (falloff > 0 ? std::exp((fog_.height - place.y) / falloff) : 1.0);
}

double Fog::left(glm::dvec3 from, glm::dvec3 direction, double distance) const {
    constexpr int steps = 400;
    double depth = 0;
    const double far = std::min(distance, endless()), step = far / steps;
    for (int i = 0; i < steps; ++i) {
        const glm::dvec3 place = from + (i + 0.5) * step * direction;
        const bool counts = std::isfinite(distance) || fog_.falloff > 0 ||
                            (place.x >= low_.x && place.y >= low_.y && place.z >= low_.z && place.x <= high_.x &&
                             place.y <= high_.y && place.z <= high_.z);
        if (counts) depth += step * extinction(place);
    }
    return std::exp(-depth);
}

double Fog::phase(double cosine) const {
    const double g = fog_.anisotropy;
    return (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

}  // namespace render2mpeg::reference
