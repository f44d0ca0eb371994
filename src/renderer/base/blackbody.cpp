#include "renderer/base/blackbody.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace render2mpeg::renderer {
namespace {

constexpr float coldest = 800.0f, hottest = 12000.0f;
constexpr int entries = 256;

/// Colour matching functions of the observer of 1931 [CIE1931], 380 nm and every 10 nm on.
constexpr double observer[][3] = {
    {0.0014, 0.0, 0.0065},   {0.0042, 0.0001, 0.0201}, {0.0143, 0.0004, 0.0679}, {0.0435, 0.0012, 0.2074},
    {0.1344, 0.004, 0.6456}, {0.2839, 0.0116, 1.3856}, {0.3483, 0.023, 1.7471},  {0.3362, 0.038, 1.7721},
    {0.2908, 0.06, 1.6692},  {0.1954, 0.091, 1.2876},  {0.0956, 0.139, 0.813},   {0.032, 0.208, 0.4652},
    {0.0049, 0.323, 0.272},  {0.0093, 0.503, 0.1582},  {0.0633, 0.71, 0.0782},   {0.1655, 0.862, 0.0422},
    {0.2904, 0.954, 0.0203}, {0.4334, 0.995, 0.0087},  {0.5945, 0.995, 0.0039},  {0.7621, 0.952, 0.0021},
    {0.9163, 0.87, 0.0017},  {1.0263, 0.757, 0.0011},  {1.0622, 0.631, 0.0008},  {1.0026, 0.503, 0.0003},
    {0.8544, 0.381, 0.0002}, {0.6424, 0.265, 0.0},     {0.4479, 0.175, 0.0},     {0.2835, 0.107, 0.0},
    {0.1649, 0.061, 0.0},    {0.0874, 0.032, 0.0},     {0.0468, 0.017, 0.0},     {0.0227, 0.0082, 0.0},
    {0.0114, 0.0041, 0.0},   {0.0058, 0.0021, 0.0},    {0.0029, 0.001, 0.0},     {0.0014, 0.0005, 0.0},
    {0.0007, 0.0003, 0.0}};

/// Planck's law as the observer sees it.
glm::vec3 integrated_color(double kelvin) {
    constexpr double second_constant = 1.4388e7;  // nm K
    glm::dvec3 xyz(0);
    double wave = 380;
    for (const auto& of : observer) {
        xyz += std::pow(550 / wave, 5) * std::expm1(second_constant / (550 * kelvin)) /
               std::expm1(second_constant / (wave * kelvin)) * glm::dvec3(of[0], of[1], of[2]);
        wave += 10;
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
    constexpr float hottest_told = 1e6f;  // its fourth power is finite
    kelvin = std::min(kelvin, hottest_told);
    const float fourth = kelvin * kelvin * kelvin * kelvin;
    const float strength = sigma_over_pi * std::max(1.0f + intensity * (fourth - 1.0f), 0.0f);
    // Cycles leaves out what is dimmer.
    return strength > 1e-5f ? strength * blackbody_color(kelvin) : glm::vec3(0);
}

}  // namespace render2mpeg::renderer
