#include "renderer/view/exposure_need.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// What is shown in this code value, or a higher one, is as bright as white (235), or brighter: lamps, mostly. chosen:
/// 210, the light 1 after exposure where there is no view.
constexpr float white_code = 210;

/// Pixels; the rims of wider discs have steps that are as wide. chosen: 64.
constexpr float widest_disc = 64;

/// Samples of a pixel that shows such light, about. chosen: 1024 of 256 to 1024 (docs/fits/exposure-samples.md).
constexpr int most_again = 1024;

bool is_white(float luminance, const ExposureSamples& wanted) {
    return luminance > 0.0f && std::isfinite(luminance) && wanted.shown(luminance) >= white_code;
}

/// Marks what lies within `radius` pixels of the way from one place to another.
void mark_way(core::Plane<std::uint8_t>& plane, glm::vec2 from, glm::vec2 to, float radius) {
    const glm::vec2 least = glm::max(glm::floor(glm::min(from, to) - radius), glm::vec2(0)),
                    most = glm::min(glm::ceil(glm::max(from, to) + radius),
                                    glm::vec2(plane.width() - 1, plane.height() - 1));
    const glm::vec2 way = to - from;
    for (int y = static_cast<int>(least.y); y <= static_cast<int>(most.y); ++y)
        for (int x = static_cast<int>(least.x); x <= static_cast<int>(most.x); ++x) {
            const glm::vec2 off = glm::vec2(x, y) - from;
            const float along = std::clamp(core::divide_or(glm::dot(off, way), glm::dot(way, way), 0.0f), 0.0f, 1.0f);
            if (glm::distance(off, along * way) <= radius) plane.at(x, y) = 1;
        }
}

}  // namespace

core::Plane<std::uint8_t> near_white(const Blur& blur, const Seen& seen, const ExposureSamples& wanted) {
    if (!wanted.shown) return {};
    const core::Visible& visible = seen.visible;
    const int width = visible.width(), height = visible.height();
    core::Plane<std::uint8_t> bright(width, height, 0), near(width, height, 0);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            bright.at(x, y) = is_white(core::luminance(seen.emitted.at(x, y)), wanted) ? 1 : 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            // What lies around an edge of it is what may end there.
            const bool inside = x > 0 && y > 0 && x + 1 < width && y + 1 < height && bright.at(x - 1, y) != 0 &&
                                bright.at(x + 1, y) != 0 && bright.at(x, y - 1) != 0 && bright.at(x, y + 1) != 0;
            if (bright.at(x, y) == 0 || inside) continue;
            const glm::vec2 here(x, y), way = blur.has_lens() ? glm::vec2(0) : blur.way_of_pixel(visible, x, y);
            const float disc = blur.has_lens() ? blur.of_pixel(visible, x, y) : 0.0f;
            if (disc < least_blur && glm::length(way) < least_blur) continue;
            // chosen: a pixel more, where a part of it is seen.
            mark_way(near, here - 0.5f * way, here + 0.5f * way, std::min(0.5f * disc, widest_disc) + 1.0f);
        }
    return near;
}

int samples_for(float blur, bool lens, const ExposureSamples& allowed) {
    const float wanted = lens ? std::max(4 * blur, 4 * blur * blur) : 4 * blur;
    int samples = std::min(allowed.fewest, allowed.most);
    while (samples < allowed.most && static_cast<float>(samples) < wanted)
        samples = std::min(2 * samples, allowed.most);
    return samples;
}

int most_samples_of(const ExposureSamples& wanted) {
    int most = wanted.most;
    while (wanted.shown && most < most_again) most *= 2;
    return most;
}

void BrightSamples::add(float luminance) {
    sum_ += luminance;
    squares_ += luminance * luminance;
    brightest_ = std::max(brightest_, luminance);
}

int BrightSamples::needed(int samples, bool near_white, const ExposureSamples& wanted) const {
    if (!wanted.shown) return samples;
    if (!is_white(brightest_, wanted)) return near_white ? std::max(samples, most_samples_of(wanted)) : samples;
    const auto n = static_cast<float>(samples);
    const float mean = sum_ / n, deviation = std::sqrt(std::max(squares_ / n - mean * mean, 0.0f));
    // Strata that are crossed by an edge err, a share of them that falls with the root of their number.
    const auto error = [&](int count) {
        return wanted.shown(mean + deviation * std::pow(static_cast<float>(count), -0.75f)) - wanted.shown(mean);
    };
    int more = samples;
    while (more < most_again && error(more) > wanted.visible) more *= 2;
    return more;
}

}  // namespace render2mpeg::renderer
