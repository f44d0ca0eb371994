#include "perceptual/eye.h"

#include <kiss_fft.h>
#include <kiss_fftr.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/constants.hpp>
#include <new>

#include "core/error.h"
#include "core/sampling.h"

namespace render2mpeg::perceptual {
namespace {

struct Freed {
    void operator()(void* memory) const { std::free(memory); }
};
using Columns = std::unique_ptr<kiss_fft_state, Freed>;
using Rows = std::unique_ptr<kiss_fftr_state, Freed>;

template <class Transform>
Transform checked(Transform made) {
    if (!made) throw std::bad_alloc();
    return made;
}

// std::complex<float> has the layout of kiss_fft_cpx, two floats.
const kiss_fft_cpx* given(const std::complex<float>* values) {
    return reinterpret_cast<const kiss_fft_cpx*>(values);
}
kiss_fft_cpx* taken(std::complex<float>* values) {
    return reinterpret_cast<kiss_fft_cpx*>(values);
}

/// Transforms all columns of a spectrum with rows of `stride` values.
void transform_columns(kiss_fft_state* transform, int stride, int height, Fourier::Spectrum& spectrum) {
    // chosen: as many side by side as fill a line of the cache.
    constexpr int most = 8;
    const auto rows = static_cast<std::size_t>(height);
    std::vector<std::complex<float>> before(most * rows), after(rows);
    for (int first = 0; first < stride; first += most) {
        const int count = std::min(most, stride - first);
        for (int y = 0; y < height; ++y)
            for (int i = 0; i < count; ++i)
                before[static_cast<std::size_t>(i * height + y)] =
                    spectrum[static_cast<std::size_t>(y * stride + first + i)];
        for (int i = 0; i < count; ++i) {
            kiss_fft(transform, given(before.data() + i * height), taken(after.data()));
            std::copy_n(after.data(), height, before.data() + i * height);
        }
        for (int y = 0; y < height; ++y)
            for (int i = 0; i < count; ++i)
                spectrum[static_cast<std::size_t>(y * stride + first + i)] =
                    before[static_cast<std::size_t>(i * height + y)];
    }
}

constexpr double widest = 9, narrowest = 1.5;  // mm
constexpr double texels_per_mm = eye_texels / aperture_mm;
constexpr double middle = eye_texels / 2;

/// Smooth noise of three octaves, about -1..1, with as many bends a second as `hertz` says in its first.
double noise(double seconds, double hertz, std::uint64_t seed) {
    double sum = 0, weight = 1;
    for (std::uint64_t octave = 0; octave < 3; ++octave, weight /= 2, hertz *= 2) {
        const double at = seconds * hertz;
        const auto cell = static_cast<std::int64_t>(std::floor(at));
        const double t = at - static_cast<double>(cell), s = t * t * (3 - 2 * t);
        const auto value = [&](std::int64_t i) {
            return 2 * static_cast<double>(core::uniform(seed, octave, static_cast<std::uint64_t>(i))) - 1;
        };
        sum += weight * (value(cell) * (1 - s) + value(cell + 1) * s);
    }
    return sum / 1.75;
}

/// Draws into an aperture, in texels.
class Drawing {
  public:
    explicit Drawing(core::Plane<float>& plane) : plane_(plane) {}

    /// A disc by its share of each texel, of what passes there.
    void disc(glm::dvec2 at, double radius, float passes) {
        const int reach = static_cast<int>(std::ceil(radius)) + 1;
        const glm::ivec2 from = glm::ivec2(glm::floor(at)) - reach, to = from + 2 * reach + 1;
        for (int y = std::max(0, from.y); y < std::min(eye_texels, to.y); ++y)
            for (int x = std::max(0, from.x); x < std::min(eye_texels, to.x); ++x) {
                const double distance = glm::length(glm::dvec2(x, y) - at);
                const auto covered = static_cast<float>(std::clamp(radius + 0.5 - distance, 0.0, 1.0));
                plane_.at(x, y) *= 1 - covered * (1 - passes);
            }
    }

    /// A line along a radius.
    void fibre(double angle, double from, double to, float passes) {
        const glm::dvec2 along(std::cos(angle), std::sin(angle));
        for (double r = from; r < to; r += 1) disc(glm::dvec2(middle) + r * along, 0.6, passes);
    }

  private:
    core::Plane<float>& plane_;
};

/// A bell with two widths [Wyman2013].
double bell(double x, double mean, double below, double above) {
    const double t = (x - mean) / (x < mean ? below : above);
    return std::exp(-0.5 * t * t);
}

/// Light of one wavelength, nm, as linear BT.709; some are negative.
glm::dvec3 colour_of(double nm) {
    const double x =
        1.056 * bell(nm, 599.8, 37.9, 31.0) + 0.362 * bell(nm, 442.0, 16.0, 26.7) - 0.065 * bell(nm, 501.1, 20.4, 26.2);
    const double y = 0.821 * bell(nm, 568.8, 46.9, 40.5) + 0.286 * bell(nm, 530.9, 16.3, 31.1);
    const double z = 1.217 * bell(nm, 437.0, 11.8, 36.0) + 0.681 * bell(nm, 459.0, 26.0, 13.8);
    return {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
            0.0557 * x - 0.2040 * y + 1.0570 * z};
}

/// Between texels; nothing beyond them.
double sampled(const core::Plane<float>& plane, glm::dvec2 at) {
    const glm::dvec2 cell = glm::floor(at), part = at - cell;
    const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y);
    if (x < 0 || y < 0 || x + 1 >= plane.width() || y + 1 >= plane.height()) return 0;
    const auto value = [&](int i, int j) { return static_cast<double>(plane.at(x + i, y + j)); };
    return (value(0, 0) * (1 - part.x) + value(1, 0) * part.x) * (1 - part.y) +
           (value(0, 1) * (1 - part.x) + value(1, 1) * part.x) * part.y;
}

}  // namespace

struct Fourier::Transforms {
    Rows rows, rows_back;
    Columns columns, columns_back;
};

Fourier::Fourier(int width, int height) {
    EXPECTS(width >= 1 && height >= 1);
    width_ = kiss_fftr_next_fast_size_real(width);
    height_ = kiss_fft_next_fast_size(height);
    transforms_ =
        std::make_unique<Transforms>(Transforms{checked(Rows(kiss_fftr_alloc(width_, 0, nullptr, nullptr))),
                                                checked(Rows(kiss_fftr_alloc(width_, 1, nullptr, nullptr))),
                                                checked(Columns(kiss_fft_alloc(height_, 0, nullptr, nullptr))),
                                                checked(Columns(kiss_fft_alloc(height_, 1, nullptr, nullptr)))});
}

Fourier::~Fourier() = default;
Fourier::Fourier(Fourier&&) noexcept = default;
Fourier& Fourier::operator=(Fourier&&) noexcept = default;

Fourier::Spectrum Fourier::spectrum(const core::Plane<float>& plane) {
    EXPECTS(plane.width() <= width_ && plane.height() <= height_);
    const int stride = width_ / 2 + 1;
    Spectrum spectrum(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height_));
    std::vector<float> row(static_cast<std::size_t>(width_));
    for (int y = 0; y < plane.height(); ++y) {
        std::copy_n(plane.row(y), plane.width(), row.data());
        kiss_fftr(transforms_->rows.get(), row.data(), taken(spectrum.data() + y * stride));
    }
    transform_columns(transforms_->columns.get(), stride, height_, spectrum);
    return spectrum;
}

core::Plane<float> Fourier::plane(Spectrum spectrum) {
    const int stride = width_ / 2 + 1;
    EXPECTS(spectrum.size() == static_cast<std::size_t>(stride) * static_cast<std::size_t>(height_));
    transform_columns(transforms_->columns_back.get(), stride, height_, spectrum);
    core::Plane<float> plane(width_, height_);
    for (int y = 0; y < height_; ++y)
        kiss_fftri(transforms_->rows_back.get(), given(spectrum.data() + y * stride), plane.row(y));
    const float scale = 1.0f / (static_cast<float>(width_) * static_cast<float>(height_));
    for (float& value : plane.values()) value *= scale;
    return plane;
}

double pupil_diameter(double luminance) {
    return 4.9 - 3 * std::tanh(0.4 * (std::log10(luminance) + 1));
}

double restless_diameter(double mean, double seconds, std::uint64_t seed) {
    // chosen: a fiftieth; the swing is the more of a pupil the narrower it is.
    constexpr double amplitude = 0.02;
    const double change = noise(seconds / mean, 2, core::mix(seed)) * widest / mean * std::sqrt(1 - mean / widest);
    return std::clamp(mean + amplitude * mean * change, narrowest, widest);
}

core::Plane<float> open_disc(double diameter) {
    core::Plane<float> plane(eye_texels, eye_texels);
    const double radius = diameter / 2 * texels_per_mm;
    for (int y = 0; y < eye_texels; ++y)
        for (int x = 0; x < eye_texels; ++x) {
            const double distance = glm::length(glm::dvec2(x, y) - middle);
            plane.at(x, y) = static_cast<float>(std::clamp(radius + 0.5 - distance, 0.0, 1.0));
        }
    return plane;
}

core::Plane<float> aperture(double diameter, double seconds, std::uint64_t seed) {
    constexpr std::uint64_t particles = 750, fibres = 200, floaters = 60;  // [Ritschel2009]; the last: chosen
    constexpr std::uint64_t of_lens = 1, of_fibres = 2, of_floaters = 3, of_focus = 4, of_glance = 5;
    const auto random = [&](std::uint64_t kind, std::uint64_t i, std::uint64_t n) {
        return static_cast<double>(core::uniform(core::mix(seed) + kind, i, n));
    };
    core::Plane<float> plane = open_disc(diameter);
    Drawing drawing(plane);

    // The lens widens and narrows as it focuses; two bands [Ritschel2009].
    const double focus = 1 + 0.02 * noise(seconds, 0.4, core::mix(seed) + of_focus) +
                         0.005 * std::sin(glm::two_pi<double>() * 1.7 * seconds);
    const double outside = widest / 2 * texels_per_mm;
    for (std::uint64_t i = 0; i < particles; ++i) {
        const double angle = glm::two_pi<double>() * random(of_lens, i, 0);
        const double r = focus * outside * std::sqrt(random(of_lens, i, 1));
        drawing.disc(glm::dvec2(middle) + r * glm::dvec2(std::cos(angle), std::sin(angle)),
                     0.5 + 1.0 * random(of_lens, i, 2), 0);
    }
    for (std::uint64_t i = 0; i < fibres; ++i) {
        const double angle = glm::two_pi<double>() * (static_cast<double>(i) + 0.7 * random(of_fibres, i, 0)) / fibres;
        const double from = focus * outside * (0.15 + 0.2 * random(of_fibres, i, 1));
        drawing.fibre(angle, from, outside, 0.6f);
    }

    // The vitreous body swings as a whole.
    const double glance = 0.3 * noise(seconds, 0.5, core::mix(seed) + of_glance);
    for (std::uint64_t i = 0; i < floaters; ++i) {
        const double angle = glance + glm::two_pi<double>() * random(of_floaters, i, 0);
        const double r = outside * std::sqrt(random(of_floaters, i, 1));
        drawing.disc(glm::dvec2(middle) + r * glm::dvec2(std::cos(angle), std::sin(angle)),
                     1 + 2 * random(of_floaters, i, 2), 0.3f);
    }
    return plane;
}

core::Plane<float> diffraction(const core::Plane<float>& aperture) {
    Fourier fourier(eye_texels, eye_texels);
    EXPECTS(fourier.width() == eye_texels && fourier.height() == eye_texels);
    const Fourier::Spectrum spectrum = fourier.spectrum(aperture);
    constexpr int stride = eye_texels / 2 + 1, half = eye_texels / 2;
    core::Plane<float> pattern(eye_texels, eye_texels);
    double sum = 0;
    for (int y = 0; y < eye_texels; ++y)
        for (int x = 0; x < eye_texels; ++x) {
            // A real aperture's spectrum has its other half mirrored.
            int u = x - half, v = y - half;
            if (u < 0) u = -u, v = -v;
            const int row = (v + eye_texels) % eye_texels;
            const float power = std::norm(spectrum[static_cast<std::size_t>(row * stride + u)]);
            pattern.at(x, y) = power;
            sum += static_cast<double>(power);
        }
    for (float& value : pattern.values()) value = static_cast<float>(static_cast<double>(value) / sum);
    return pattern;
}

core::Plane<float> scattered(core::Plane<float> pattern, double diameter) {
    const double ring = 1.22 * aperture_mm / diameter;  // [Airy1835]
    double sum = 0;
    for (int y = 0; y < eye_texels; ++y)
        for (int x = 0; x < eye_texels; ++x) {
            const double distance = glm::length(glm::dvec2(x, y) - middle);
            pattern.at(x, y) *= static_cast<float>(std::clamp(distance - ring, 0.0, 1.0));
            sum += static_cast<double>(pattern.at(x, y));
        }
    for (float& value : pattern.values()) value = static_cast<float>(static_cast<double>(value) / sum);
    return pattern;
}

core::Plane<glm::vec3> in_colour(const core::Plane<float>& pattern) {
    constexpr int wavelengths = 32;
    constexpr double reference = 575, first = 380, last = 770;
    std::array<double, wavelengths> scales{};
    std::array<glm::dvec3, wavelengths> colours{};
    for (int i = 0; i < wavelengths; ++i) {
        const double nm = first + (last - first) * (i + 0.5) / wavelengths;
        scales[static_cast<std::size_t>(i)] = reference / nm;
        colours[static_cast<std::size_t>(i)] = colour_of(nm) * (reference / nm) * (reference / nm);
    }
    core::Plane<glm::vec3> coloured(pattern.width(), pattern.height());
    const glm::dvec2 centre(pattern.width() / 2, pattern.height() / 2);
    glm::dvec3 sum(0);
    for (int y = 0; y < pattern.height(); ++y)
        for (int x = 0; x < pattern.width(); ++x) {
            glm::dvec3 light(0);
            for (std::size_t i = 0; i < wavelengths; ++i)
                light += colours[i] * sampled(pattern, centre + (glm::dvec2(x, y) - centre) * scales[i]);
            light = glm::max(light, glm::dvec3(0));
            sum += light;
            coloured.at(x, y) = glm::vec3(light);
        }
    for (glm::vec3& value : coloured.values()) value = glm::vec3(glm::dvec3(value) / sum);
    return coloured;
}

}  // namespace render2mpeg::perceptual
