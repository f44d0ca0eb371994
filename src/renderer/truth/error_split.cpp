#include "renderer/truth/error_split.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// A pixel's differences by cause, against one half of its truth.
std::array<double, cause_count> differences(const JudgedPixel& p, std::size_t half) {
    const double at_points = p.truth.at_points.luminance_of(half), whole = p.truth.whole.luminance_of(half);
    return {p.shown - p.where_lit, p.where_lit - p.at_points, p.at_points - at_points, at_points - whole,
            p.shown - whole};
}

/// Luminance of the pixel that has half of them below it.
double median(std::span<const JudgedPixel> pixels) {
    std::vector<double> luminances;
    for (const JudgedPixel& p : pixels) luminances.push_back(p.at_points);
    const auto middle = luminances.begin() + static_cast<std::ptrdiff_t>(luminances.size() / 2);
    std::nth_element(luminances.begin(), middle, luminances.end());
    return *middle;
}

/// Of `count` values with these sums.
MeanError mean_of(double sum, double squares, std::uint64_t count) {
    const auto n = static_cast<double>(count);
    const double mean = core::divide_or(sum, n, 0.0);
    return {mean, core::sqrt_or_zero(core::divide_or(squares / n - mean * mean, n - 1, 0.0))};
}

MeanError over_light(MeanError m, double light, std::uint64_t count) {
    const double scale = core::divide_or(static_cast<double>(count), light, 0.0);
    return {scale * m.value, std::abs(scale) * m.error};
}

}  // namespace

double JudgedPixel::luminance() const {
    return std::max(at_points, least);
}

void ErrorSplit::add(std::span<const JudgedPixel> pixels) {
    if (pixels.empty()) return;
    const double middle = median(pixels);
    for (const JudgedPixel& p : pixels) {
        const bool dark = p.at_points < middle;
        const double light = p.truth.whole.luminance(), luminance = p.luminance();
        ++sums_.pixels;
        sums_.paths += p.truth.paths;
        sums_.light += light;
        if (dark) {
            ++sums_.dark_pixels;
            sums_.dark_light += light;
        }
        const std::array<double, cause_count> one = differences(p, 0), other = differences(p, 1);
        for (std::size_t c = 0; c < cause_count; ++c) {
            CauseSums& s = sums_.causes[c];
            const double difference = 0.5 * (one[c] + other[c]);
            // Independent halves: the mean of their product is the square of the mean.
            const double square = one[c] * other[c];
            const double relative = core::divide_or(square, luminance * luminance, 0.0);
            s.difference += difference;
            s.difference_squares += difference * difference;
            if (dark) {
                s.dark_difference += difference;
                s.dark_difference_squares += difference * difference;
            }
            s.squares += square;
            s.square_squares += square * square;
            s.relative_squares += relative;
            s.relative_square_squares += relative * relative;
        }
    }
}

MeanError ErrorSplit::mean_square(ErrorCause cause) const {
    return mean_of(of(cause).squares, of(cause).square_squares, sums_.pixels);
}

MeanError ErrorSplit::relative_mean_square(ErrorCause cause) const {
    return mean_of(of(cause).relative_squares, of(cause).relative_square_squares, sums_.pixels);
}

double ErrorSplit::rms(ErrorCause cause) const {
    return core::sqrt_or_zero(mean_square(cause).value);
}

double ErrorSplit::relative_rms(ErrorCause cause) const {
    return core::sqrt_or_zero(relative_mean_square(cause).value);
}

MeanError ErrorSplit::bias(ErrorCause cause) const {
    const CauseSums& s = of(cause);
    return over_light(mean_of(s.difference, s.difference_squares, sums_.pixels), sums_.light, sums_.pixels);
}

MeanError ErrorSplit::dark_bias(ErrorCause cause) const {
    const CauseSums& s = of(cause);
    return over_light(mean_of(s.dark_difference, s.dark_difference_squares, sums_.dark_pixels), sums_.dark_light,
                      sums_.dark_pixels);
}

}  // namespace render2mpeg::renderer
