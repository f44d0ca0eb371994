#include "core/film_grain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/sampling.h"

namespace render2mpeg::core {
namespace {

/// A frame of 35 mm film, in micrometres.
constexpr double frame_height = 18660;
/// Radius of grains at ISO 100, micrometres. A grain's area is proportional to the speed.
/// chosen: two code values in mid tones of 1080 lines; four at ISO 400.
constexpr double grain_radius = 0.55;
/// Standard deviation of clumps at ISO 100, micrometres, growing with the cube root of the speed; and of the blur of
/// lens and scanner, pixels. chosen: grain is seen and not its grid: 0.76 pixels in 1080 lines at ISO 100, 1.3 at 6400.
constexpr double clump = 5, scanner = 0.7;
/// chosen: the limit of what AV1's filter of three rows follows; smaller grain would show in 4320 lines.
constexpr double largest_spot = 2;

/// Area that two discs of radius 1 share at this distance.
double shared_area(double distance) {
    return 2 * std::acos(distance / 2) - distance / 2 * std::sqrt(4 - distance * distance);
}

/// Integral of the covariance of the boolean model of discs of radius 1, where they cover this share, 0..1.
/// [Newson2017, section 3]: (1 - u)^2 (exp(lambda gamma(h)) - 1), u = 1 - exp(-lambda pi).
double integral_of_covariance(double covered) {
    if (covered >= 1) return 0;
    const double intensity = -std::log(1 - covered) / std::numbers::pi;
    constexpr int intervals = 64;
    double sum = 0;
    for (int i = 0; i < intervals; ++i) {
        const double distance = 2 * (i + 0.5) / intervals;
        sum += 2 * std::numbers::pi * distance * std::expm1(intensity * shared_area(distance)) * 2 / intervals;
    }
    return (1 - covered) * (1 - covered) * sum;
}

/// Gaussian weights about the middle whose squares have the sum 1.
std::vector<float> spot_weights(double spot) {
    const int radius = static_cast<int>(std::ceil(3 * spot));
    std::vector<float> weights;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
        const double weight = std::exp(-i * i / (2 * spot * spot));
        weights.push_back(static_cast<float>(weight));
        sum += weight * weight;
    }
    for (float& weight : weights) weight /= static_cast<float>(std::sqrt(sum));
    return weights;
}

/// Nearly normal, with mean 0 and variance 1: four uniform numbers' sum.
float white(std::uint64_t bits) {
    const auto sum = static_cast<float>((bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48));
    return (sum - 2 * 65535.0f) * (1.7320508f / 65536.0f);
}

}  // namespace

FilmGrain::FilmGrain(int iso, int height) {
    EXPECTS(iso >= least_iso && iso <= most_iso && height > 0);
    const double pixel = frame_height / height, speed = iso / 100.0;
    spot_ = std::min(std::hypot(scanner, clump * std::cbrt(speed) / pixel), largest_spot);
    // The blur's own square has the integral 1 / (4 pi spot^2).
    const double grains = grain_radius * grain_radius * speed / (4 * std::numbers::pi * spot_ * spot_ * pixel * pixel);
    for (int i = 0; i <= steps; ++i)
        deviation_[static_cast<std::size_t>(i)] =
            static_cast<float>(steps * std::sqrt(grains * integral_of_covariance(i / static_cast<double>(steps))));
}

float FilmGrain::deviation(float luma) const {
    const float at = std::clamp(luma - 16.0f, 0.0f, static_cast<float>(steps));
    const int below = std::min(static_cast<int>(at), steps - 1);
    const float part = at - static_cast<float>(below);
    const auto i = static_cast<std::size_t>(below);
    return (1 - part) * deviation_[i] + part * deviation_[i + 1];
}

Plane<float> FilmGrain::noise(int width, int height, std::int64_t frame) const {
    const std::vector<float> weights = spot_weights(spot_);
    const int taps = static_cast<int>(weights.size()), wide = width + taps - 1;
    const std::uint64_t seed = mix(static_cast<std::uint64_t>(frame) ^ 0x6772'6169'6e00'0000);
    std::vector<float> row(static_cast<std::size_t>(wide));
    Plane<float> across(width, height + taps - 1), result(width, height, 0.0f);
    for (int y = 0; y < across.height(); ++y) {
        const std::uint64_t place = seed + static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(wide);
        for (std::size_t x = 0; x < row.size(); ++x) row[x] = white(mix(place + x));
        float* out = across.row(y);
        for (int x = 0; x < width; ++x) out[x] = 0;
        for (int i = 0; i < taps; ++i)
            for (int x = 0; x < width; ++x)
                out[x] += weights[static_cast<std::size_t>(i)] * row[static_cast<std::size_t>(x + i)];
    }
    for (int y = 0; y < height; ++y)
        for (int i = 0; i < taps; ++i) {
            const float* from = across.row(y + i);
            float* out = result.row(y);
            for (int x = 0; x < width; ++x) out[x] += weights[static_cast<std::size_t>(i)] * from[x];
        }
    return result;
}

namespace {

/// Luma becomes `changed` of it, its grain, and noise of deviation 1.
template <class Change>
void change_luma(Picture& picture, int iso, const Change& changed) {
    if (iso == 0 || picture.y.empty()) return;
    const FilmGrain grain(iso, picture.height());
    const Plane<float> noise = grain.noise(picture.width(), picture.height(), picture.number);
    for (std::size_t i = 0; i < noise.size(); ++i) {
        std::uint8_t& y = picture.y.values()[i];
        const float luma = picture.luma.empty() ? static_cast<float>(y) : picture.luma.values()[i];
        const float now = std::clamp(changed(luma, grain, noise.values()[i]), 16.0f, 235.0f);
        if (!picture.luma.empty()) picture.luma.values()[i] = now;
        y = static_cast<std::uint8_t>(std::lround(now));
    }
}

}  // namespace

void add_grain(Picture& picture, int iso) {
    change_luma(picture, iso,
                [](float luma, const FilmGrain& grain, float noise) { return luma + grain.deviation(luma) * noise; });
}

void take_grain(Picture& picture, int iso) {
    change_luma(picture, iso, [](float grained, const FilmGrain& grain, float noise) {
        // The deviation changes slowly with luma: each step errs by a small part of the one before.
        constexpr int steps = 6;
        float luma = grained;
        for (int step = 0; step < steps; ++step)
            luma = std::clamp(grained - grain.deviation(luma) * noise, 16.0f, 235.0f);
        return luma;
    });
}

}  // namespace render2mpeg::core
