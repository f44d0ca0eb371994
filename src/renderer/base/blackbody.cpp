#include "renderer/base/blackbody.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace render2mpeg::renderer {
namespace {

constexpr float coldest = 800.0f, hottest = 12000.0f;
constexpr int entries = 256;

/// A lobe of the fit of the colour matching functions.
double peak(double nanometres, double middle, double below, double above) {
    const double s = (nanometres - middle) / (nanometres < middle ? below : above);
    return std::exp(-0.5 * s * s);
}

/// Planck's law over the fit of CIE 1931's functions [Wyman2013].
glm::vec3 integrated_color(double kelvin) {
    glm::dvec3 xyz(0);
    for (int l = 380; l <= 780; l += 5) {
        const double planck =
            std::pow(550.0 / l, 5) * (std::expm1(1.4388e7 / (550.0 * kelvin))) / std::expm1(1.4388e7 / (l * kelvin));
        xyz += planck * glm::dvec3(1.056 * peak(l, 599.8, 37.9, 31.0) + 0.362 * peak(l, 442.0, 16.0, 26.7) -
                                       0.065 * peak(l, 501.1, 20.4, 26.2),
                                   0.821 * peak(l, 568.8, 46.9, 40.5) + 0.286 * peak(l, 530.9, 16.3, 31.1),
                                   1.217 * peak(l, 437.0, 11.8, 36.0) + 0.681 * peak(l, 459.0, 26.0, 13.8));
    }
    xyz /= xyz.y;
    const glm::dvec3 rgb(3.2406 * xyz.x - 1.5372 * xyz.y - 0.4986 * xyz.z,
                         -0.9689 * xyz.x + 1.8758 * xyz.y + 0.0415 * xyz.z,
                         0.0557 * xyz.x - 0.2040 * xyz.y + 1.0570 * xyz.z);
    return glm::vec3(glm::max(rgb, glm::dvec3(0)));
}

/// By evenly rising inverse temperatures.
const std::array<glm::vec3, entries>& colors() {
    static const std::array<glm::vec3, entries> table = [] {
        std::array<glm::vec3, entries> all;
        for (int i = 0; i < entries; ++i)
            all[std::size_t(i)] =
                integrated_color(1.0 / (1.0 / hottest + (1.0 / coldest - 1.0 / hottest) * i / (entries - 1)));
        return all;
    }();
    return table;
}

}  // namespace

glm::vec3 blackbody_color(float kelvin) {
    const float inverse = 1.0f / std::clamp(kelvin, coldest, hottest);
    const float at = (inverse - 1.0f / hottest) / (1.0f / coldest - 1.0f / hottest) * (entries - 1);
    const int low = std::clamp(int(at), 0, entries - 2);
    return glm::mix(colors()[std::size_t(low)], colors()[std::size_t(low) + 1],
                    std::clamp(at - float(low), 0.0f, 1.0f));
}

glm::vec3 blackbody_radiance(float kelvin, float intensity) {
    constexpr float sigma_over_pi = 5.670373e-14f / 3.14159265f;
    const float fourth = kelvin * kelvin * kelvin * kelvin;
    const float strength = sigma_over_pi * std::max(1.0f + intensity * (fourth - 1.0f), 0.0f);
    // Cycles leaves out what is dimmer.
    return strength > 1e-5f ? strength * blackbody_color(kelvin) : glm::vec3(0);
}

}  // namespace render2mpeg::renderer
