#include "image/sky_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::image {
namespace {

/// chosen: sums over a whole map of them stay finite.
constexpr float largest_radiance = 1e18f;
/// Probes that a texture has for a long footprint; longer ones would be blurred across, too.
constexpr float longest_footprint = 16;

/// Columns of the grid that an even sky is divided by. chosen: 512, cells of 0.7 degrees; a hundred thousand of them.
constexpr int even_columns = 512;

float usable(float radiance) {
    if (!(radiance > 0)) return 0.0f;
    return std::isinf(radiance) ? overflowed : std::min(radiance, largest_radiance);
}

/// Evenly spread directions that stand for equal solid angles: a Fibonacci spiral. [Swinbank2006]
glm::vec3 spiral_direction(int i, int count) {
    const double y = 1 - (2.0 * i + 1) / count;
    const double turn = i * (2 * std::numbers::pi * (1 - 1 / std::numbers::phi));
    const double r = core::sqrt_or_zero(1 - y * y);
    return {r * std::cos(turn), y, r * std::sin(turn)};
}

}  // namespace

SkyMap::SkyMap(glm::vec3 radiance) : mean_(usable(radiance.x), usable(radiance.y), usable(radiance.z)) {}

SkyMap::SkyMap(const Image& image, glm::vec3 factor, float rotation)
    : cos_rotation_(std::cos(rotation)), sin_rotation_(std::sin(rotation)) {
    EXPECTS(std::isfinite(rotation));
    const int width = image.pixels.width(), height = image.pixels.height();
    if (width == 0 || height == 0) return;

    // Make the radiance linear and usable. Its alpha weighs a row by its solid angle, so that the texture's means are
    // means over the sphere and not over the image.
    Image sky{core::Plane<glm::vec4>(width, height), true, true};
    for (int y = 0; y < height; ++y) {
        const auto weight = static_cast<float>(std::sin(std::numbers::pi * (y + 0.5) / height));
        for (int x = 0; x < width; ++x) {
            const glm::vec4 p = image.pixels.at(x, y);
            glm::vec4& radiance = sky.pixels.at(x, y);
            for (int c = 0; c < 3; ++c)
                radiance[c] =
                    usable(factor[c] * (image.high_range ? usable(p[c]) : core::srgb_to_linear(usable(p[c]))));
            radiance.w = weight;
        }
    }
    grid_ = SkyGrid(sky.pixels);
    mean_ = grid_.total() / (4 * std::numbers::pi_v<float>);
    texture_ =
        Texture(sky, Encoding::linear, core::Wrap::repeat, core::Wrap::clamp_to_edge, false, AlphaMeaning::coverage);
}

glm::vec3 SkyMap::to_world(glm::vec3 d) const {
    return {cos_rotation_ * d.x + sin_rotation_ * d.z, d.y, cos_rotation_ * d.z - sin_rotation_ * d.x};
}

glm::vec3 SkyMap::to_map(glm::vec3 d) const {
    return {cos_rotation_ * d.x - sin_rotation_ * d.z, d.y, cos_rotation_ * d.z + sin_rotation_ * d.x};
}

glm::vec3 SkyMap::radiance(glm::vec3 direction, float solid_angle) const {
    const glm::vec3 d = core::normalize_or(to_map(direction), glm::vec3(0));
    if (uniform() || d == glm::vec3(0) || !(solid_angle < 4 * std::numbers::pi_v<float>)) return mean_;

    // Take the cone for a square of the same solid angle, along the meridians.
    constexpr float turn = 2 * std::numbers::pi_v<float>;
    const float sine = std::sqrt(d.x * d.x + d.z * d.z);
    const glm::vec2 uv{0.5f + std::atan2(d.x, -d.z) / turn, std::atan2(sine, d.y) / (0.5f * turn)};
    const float side = core::sqrt_or_zero(solid_angle);
    const float high = std::min(side / (0.5f * turn), 1.0f);
    const float widest = longest_footprint * std::max(high * static_cast<float>(texture_.height()), 1.0f);
    const float wide =
        std::min({core::divide_or(side, sine * turn, 1.0f), 1.0f, widest / static_cast<float>(texture_.width())});
    return glm::vec3(texture_.sample(uv, {{wide, 0}, {0, high}}));
}

glm::vec3 SkyMap::radiance_of_ray(glm::vec3 direction, float solid_angle) const {
    constexpr float turn = 2 * std::numbers::pi_v<float>;
    const glm::vec3 d = to_map(direction);
    if (uniform() || !(solid_angle < 2 * turn)) return mean_;
    const float sine = std::sqrt(d.x * d.x + d.z * d.z);
    const glm::vec2 uv{0.5f + std::atan2(d.x, -d.z) / turn, std::atan2(sine, d.y) / (0.5f * turn)};
    const float high = core::sqrt_or_zero(solid_angle) / (0.5f * turn);
    return glm::vec3(texture_.probe(uv, high * static_cast<float>(texture_.height())));
}

std::vector<SkySample> SkyMap::samples(int count, const SkyImportance& importance) const {
    if (count <= 0 || !(core::luminance(mean_) > 0)) return {};
    std::vector<SkySample> samples;
    if (uniform() && !importance) {
        const float solid_angle = 4 * std::numbers::pi_v<float> / static_cast<float>(count);
        for (int i = 0; i < count; ++i)
            samples.push_back(
                {spiral_direction(i, count), mean_ * solid_angle, solid_angle, static_cast<std::uint32_t>(i)});
        return samples;
    }
    SkyImportance in_map;
    if (importance) in_map = [&](glm::vec3 direction) { return importance(to_world(direction)); };
    samples = (uniform() ? SkyGrid(core::Plane<glm::vec4>(even_columns, even_columns / 2, glm::vec4(mean_, 1))) : grid_)
                  .divide(count, in_map);
    for (SkySample& sample : samples) sample.direction = to_world(sample.direction);
    return samples;
}

}  // namespace render2mpeg::image
