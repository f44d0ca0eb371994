#include "renderer/view/exposure_need.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/allocation.h"

namespace render2mpeg::renderer {
namespace {

/// Least code value that counts as bright as white (235), or brighter: lamps, mostly. chosen: 210, the light 1 after
/// exposure where there is no view.
constexpr float white_code = 210;

/// Pixels; wider discs and longer motions are dimmer, so that one sample shows less of them. chosen: 64 and
/// 256.
constexpr float widest_radius = 64, longest_motion = 256;

/// Samples of a pixel that shows such light, about. chosen: 1024, not tuned.
constexpr int most_again = 1024;

bool is_white(float luminance, const ExposureSamples& wanted) {
    return luminance > 0.0f && std::isfinite(luminance) && wanted.shown(luminance) >= white_code;
}

/// Beginnings and ends of marked runs in rows: adds up to how often a pixel is, from left to right.
class Marks {
  public:
    Marks(int width, int height) : steps_(width + 1, height, 0) {}

    void disc(glm::vec2 middle, float radius) {
        const int least = std::max(static_cast<int>(std::ceil(middle.y - radius)), 0),
                  most = std::min(static_cast<int>(std::floor(middle.y + radius)), steps_.height() - 1);
        for (int y = least; y <= most; ++y) {
            const float off = static_cast<float>(y) - middle.y,
                        half = std::sqrt(std::max(radius * radius - off * off, 0.0f));
            const float width = static_cast<float>(steps_.width() - 1);
            const float from = std::ceil(middle.x - half), to = std::floor(middle.x + half) + 1;
            if (!(from < width && to > 0.0f)) continue;
            ++steps_.at(static_cast<int>(std::max(from, 0.0f)), y);
            --steps_.at(static_cast<int>(std::min(to, width)), y);
        }
    }

    core::Plane<std::uint8_t> plane() const {
        core::Plane<std::uint8_t> marked(steps_.width() - 1, steps_.height(), 0);
        for (int y = 0; y < marked.height(); ++y)
            for (int x = 0, count = 0; x < marked.width(); ++x) {
                count += steps_.at(x, y);
                marked.at(x, y) = count > 0 ? 1 : 0;
            }
        return marked;
    }

  private:
    core::Plane<int> steps_;
};

/// The least luminance, a power of two to a 64th, that is shown as white.
float least_white(const ExposureSamples& wanted) {
    float dark = -64, white = 64;
    while (white - dark > 1.0f / 64) {
        const float middle = 0.5f * (dark + white);
        (is_white(std::exp2(middle), wanted) ? white : dark) = middle;
    }
    return std::exp2(white);
}

}  // namespace

core::Plane<std::uint8_t> near_white(const Blur& blur, const Frame& seen, const ExposureSamples& wanted) {
    if (!wanted.shown) return {};
    const core::Visible& visible = seen.visible;
    const int width = visible.width(), height = visible.height();
    const float white = least_white(wanted);
    const auto is_bright = [&](int x, int y) {
        return x < 0 || y < 0 || x >= width || y >= height || core::luminance(seen.emitted.at(x, y)) >= white;
    };
    Marks marks(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            // Blurred edges of a bright area may end anywhere around them.
            if (!is_bright(x, y) ||
                (is_bright(x - 1, y) && is_bright(x + 1, y) && is_bright(x, y - 1) && is_bright(x, y + 1)))
                continue;
            const glm::vec2 here(x, y), motion = blur.has_lens() ? glm::vec2(0) : blur.motion_of_pixel(visible, x, y);
            const float disc = blur.has_lens() ? blur.of_pixel(visible, x, y) : 0.0f, length = glm::length(motion);
            if (!std::isfinite(length) || !(disc >= least_blur || length >= least_blur)) continue;
            // chosen: a pixel more, where a part of it is seen.
            const float radius = std::min(0.5f * disc, widest_radius) + 1.0f;
            const int steps = static_cast<int>(std::min(length, longest_motion));
            for (int k = 0; k <= steps; ++k)
                marks.disc(
                    here + (core::divide_or(static_cast<float>(k), static_cast<float>(steps), 0.5f) - 0.5f) * motion,
                    radius);
        }
    return marks.plane();
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
    const auto error = [&](int count) {
        return wanted.shown(mean + deviation * strata_error(static_cast<float>(count))) - wanted.shown(mean);
    };
    int more = samples;
    while (more < most_again && error(more) > wanted.visible) more *= 2;
    return more;
}

}  // namespace render2mpeg::renderer
