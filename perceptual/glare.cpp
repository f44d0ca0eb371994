#include "perceptual/glare.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <tuple>
#include <utility>

#include "core/error.h"

namespace render2mpeg::perceptual {
namespace {

/// Radii of scattered light, in cells.
glm::ivec2 reach_of(const core::Glare& settings, int height, float pixel_aspect, int step) {
    const float high = settings.size * static_cast<float>(height) / static_cast<float>(step);
    return glm::max(glm::ivec2(1), glm::ivec2(glm::ceil(glm::vec2(high / pixel_aspect, high))));
}

/// Light of step x step pixels over their number; of fewer at the right and lower border, over that number, too.
core::Plane<float> reduced(const core::Plane<glm::vec3>& plane, int channel, int step, float most) {
    core::Plane<float> cells((plane.width() + step - 1) / step, (plane.height() + step - 1) / step);
    for (int y = 0; y < cells.height(); ++y)
        for (int x = 0; x < cells.width(); ++x) {
            const int right = std::min(plane.width(), (x + 1) * step), low = std::min(plane.height(), (y + 1) * step);
            float sum = 0;
            for (int j = y * step; j < low; ++j)
                for (int i = x * step; i < right; ++i) sum += std::min(plane.at(i, j)[channel], most);
            cells.at(x, y) = sum / static_cast<float>(step * step);
        }
    return cells;
}

/// The plane's value at a pixel, between its cells of step x step pixels.
float between(const core::Plane<float>& cells, int x, int y, int step) {
    if (step == 1) return cells.at(x, y);
    const glm::ivec2 last(cells.width() - 1, cells.height() - 1);
    const glm::vec2 at = (glm::vec2(x, y) + 0.5f) / static_cast<float>(step) - 0.5f;
    const glm::vec2 inside = glm::clamp(at, glm::vec2(0), glm::vec2(last));
    const glm::ivec2 from(inside), to = glm::min(from + 1, last);
    const glm::vec2 part = inside - glm::vec2(from);
    return (cells.at(from.x, from.y) * (1 - part.x) + cells.at(to.x, from.y) * part.x) * (1 - part.y) +
           (cells.at(from.x, to.y) * (1 - part.x) + cells.at(to.x, to.y) * part.x) * part.y;
}

/// How much of the veil falls at a distance from its light, as a share of its reach: as the inverse square, further out
/// as the inverse cube [Ritschel2009], and softly none at the reach.
double veil_at(double distance) {
    constexpr double core = 1.0 / 256, knee = 0.25;  // chosen: a texel of the pattern; a quarter
    if (distance >= 1) return 0;
    const double end = 1 - distance * distance;
    return end * end / ((distance * distance + core * core) * std::sqrt(1 + distance * distance / (knee * knee)));
}

/// Position in cells from the middle, as a share of the reach there.
glm::dvec2 share_of(glm::dvec2 cells, glm::ivec2 reach) {
    return cells / (glm::dvec2(reach) + 0.5);
}

/// The veil's mean over a cell at this offset from the middle.
double veil_over(glm::ivec2 offset, glm::ivec2 reach) {
    // chosen: cells near the light are looked at closely; further out it is nearly even over a cell.
    const int samples = std::abs(offset.x) + std::abs(offset.y) < 4 ? 32 : 2;
    double sum = 0;
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
            const glm::dvec2 inside = (glm::dvec2(i, j) + 0.5) / static_cast<double>(samples) - 0.5;
            sum += veil_at(glm::length(share_of(glm::dvec2(offset) + inside, reach)));
        }
    return sum / (samples * samples);
}

/// The pattern's mean over a cell at this offset from the middle.
glm::dvec3 mean_over(const core::Plane<glm::vec3>& pattern, glm::ivec2 offset, glm::ivec2 reach) {
    const glm::dvec2 texels = eye_texels / 2.0 / glm::dvec2(reach);
    const int samples = std::max(1, static_cast<int>(std::ceil(2 * std::max(texels.x, texels.y))));
    glm::dvec3 sum(0);
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
            const glm::dvec2 inside = (glm::dvec2(i, j) + 0.5) / static_cast<double>(samples) - 0.5;
            const glm::dvec2 at = (glm::dvec2(offset) + inside) * texels + eye_texels / 2.0;
            const glm::dvec2 cell = glm::floor(at), part = at - cell;
            const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y);
            if (x < 0 || y < 0 || x + 1 >= eye_texels || y + 1 >= eye_texels) continue;
            const auto value = [&](int k, int l) { return glm::dvec3(pattern.at(x + k, y + l)); };
            sum += (value(0, 0) * (1 - part.x) + value(1, 0) * part.x) * (1 - part.y) +
                   (value(0, 1) * (1 - part.x) + value(1, 1) * part.x) * part.y;
        }
    return sum / static_cast<double>(samples * samples);
}

/// Scattering kernel of a cell's light, for distances of up to `reach` cells, the middle at `reach`; sums are 1.
core::Plane<glm::vec3> kernel_of(const core::Plane<glm::vec3>& pattern, glm::ivec2 reach) {
    const glm::ivec2 sides = 2 * reach + 1;
    core::Plane<glm::dvec3> needles(sides.x, sides.y);
    core::Plane<double> veil(sides.x, sides.y);
    glm::dvec3 needles_sum(0);
    double veil_sum = 0;
    for (int y = 0; y < sides.y; ++y)
        for (int x = 0; x < sides.x; ++x) {
            const glm::ivec2 offset = glm::ivec2(x, y) - reach;
            const double distance = glm::length(share_of(glm::dvec2(offset), reach));
            const double inside = std::max(0.0, 1 - distance * distance);
            needles.at(x, y) = mean_over(pattern, offset, reach) * inside;
            veil.at(x, y) = veil_over(offset, reach);
            needles_sum += needles.at(x, y);
            veil_sum += veil.at(x, y);
        }
    core::Plane<glm::vec3> kernel(sides.x, sides.y);
    for (int y = 0; y < sides.y; ++y)
        for (int x = 0; x < sides.x; ++x)
            kernel.at(x, y) = glm::vec3(0.5 * needles.at(x, y) / needles_sum + 0.5 * veil.at(x, y) / veil_sum);
    return kernel;
}

/// The upper left part.
core::Plane<float> part_of(const core::Plane<float>& plane, int width, int height) {
    core::Plane<float> part(width, height);
    for (int y = 0; y < height; ++y) std::copy_n(plane.row(y), width, part.row(y));
    return part;
}

/// chosen: cells of one pixel up to 600 lines, of two up to 1000, of three at 1080.
int step_of(int height) {
    return std::max(1, (height + 200) / 400);
}

}  // namespace

Glare::Glare(const core::Glare& settings, int width, int height, float pixel_aspect, float exposure)
    : settings_(settings),
      width_(width),
      height_(height),
      step_(step_of(height)),
      // Luminance shown as mid grey at this exposure, at 179 lm/W [Ward1998].
      pupil_(pupil_diameter(179 * 0.18 * std::exp2(-static_cast<double>(exposure)))),
      brightest_(4096 * std::exp2(-exposure)),
      reach_(reach_of(settings, height, pixel_aspect, step_)),
      fourier_((width + step_ - 1) / step_ + reach_.x, (height + step_ - 1) / step_ + reach_.y) {
    EXPECTS(settings.shows() && settings.size > 0 && width >= 1 && height >= 1 && pixel_aspect > 0);
}

core::Plane<glm::vec3> Glare::pattern_at(double seconds) const {
    const auto at = [&](double when) {
        const double diameter = restless_diameter(pupil_, when, settings_.seed);
        return scattered(diffraction(aperture(diameter, when, settings_.seed)), diameter);
    };
    if (settings_.kind == core::GlareKind::temporal) return in_colour(at(seconds));
    // chosen: the mean of 16 moments, so that nothing moves and the pattern has no grain.
    constexpr int moments = 16;
    core::Plane<float> mean(eye_texels, eye_texels);
    for (int i = 0; i < moments; ++i) {
        const core::Plane<float> one = at(1.7 * i);
        for (std::size_t k = 0; k < mean.size(); ++k) mean.values()[k] += one.values()[k] / moments;
    }
    return in_colour(mean);
}

Glare::Scattering Glare::scattering_at(double seconds) {
    Scattering scattering;
    const int across = (width_ + step_ - 1) / step_, down = (height_ + step_ - 1) / step_;
    const core::Plane<glm::vec3> kernel = kernel_of(pattern_at(seconds), reach_);
    const Fourier::Spectrum ones =
        fourier_.spectrum(reduced(core::Plane<glm::vec3>(width_, height_, glm::vec3(1)), 0, step_, 1));
    for (int c = 0; c < 3; ++c) {
        // The middle goes to (0, 0): what lies before it comes from the other end. Nothing reaches further than the
        // padding, so that nothing comes round.
        core::Plane<float> turned(fourier_.width(), fourier_.height());
        for (int y = 0; y < kernel.height(); ++y)
            for (int x = 0; x < kernel.width(); ++x) {
                const int i = (x - reach_.x + fourier_.width()) % fourier_.width();
                const int j = (y - reach_.y + fourier_.height()) % fourier_.height();
                turned.at(i, j) += kernel.at(x, y)[c];
            }
        const auto channel = static_cast<std::size_t>(c);
        scattering.kernel[channel] = fourier_.spectrum(turned);
        Fourier::Spectrum stays = scattering.kernel[channel];
        for (std::size_t i = 0; i < stays.size(); ++i) stays[i] *= ones[i];
        scattering.kept[channel] = part_of(fourier_.plane(std::move(stays)), across, down);
    }
    return scattering;
}

/// Makes the pattern of this moment. That of a still eye is kept for the film's other chunks.
void Glare::see(double seconds) {
    if (settings_.kind == core::GlareKind::temporal) {
        scattering_ = std::make_shared<const Scattering>(scattering_at(seconds));
        return;
    }
    if (scattering_) return;
    static std::mutex busy;
    static std::tuple<core::Glare, int, int, glm::ivec2, double> made_for;
    static std::shared_ptr<const Scattering> made;
    const std::scoped_lock lock(busy);
    core::Glare pattern = settings_;
    pattern.strength = 0;  // decides how much of it is added
    const auto wanted = std::tuple(pattern, width_, height_, reach_, pupil_);
    if (!made || made_for != wanted) {
        made = std::make_shared<const Scattering>(scattering_at(seconds));
        made_for = wanted;
    }
    scattering_ = made;
}

core::Plane<glm::vec3> Glare::over(const core::Plane<glm::vec3>& radiance, double seconds) {
    EXPECTS(radiance.width() == width_ && radiance.height() == height_);
    see(seconds);
    core::Plane<glm::vec3> glared = radiance;
    for (int c = 0; c < 3; ++c) {
        const auto channel = static_cast<std::size_t>(c);
        const core::Plane<float> cells = reduced(radiance, c, step_, brightest_);
        Fourier::Spectrum scattered = fourier_.spectrum(cells);
        for (std::size_t i = 0; i < scattered.size(); ++i) scattered[i] *= scattering_->kernel[channel][i];
        const core::Plane<float> veil = part_of(fourier_.plane(std::move(scattered)), cells.width(), cells.height());
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                const float scatters = settings_.strength * between(scattering_->kept[channel], x, y, step_);
                const float comes = settings_.strength * std::max(0.0f, between(veil, x, y, step_));
                float& light = glared.at(x, y)[c];
                light += comes - scatters * std::min(light, brightest_);
                light = std::max(light, 0.0f);
            }
    }
    return glared;
}

}  // namespace render2mpeg::perceptual
