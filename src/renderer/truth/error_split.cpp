#include "renderer/truth/error_split.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/color.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// A pixel's differences by cause, against one half of its truth, for something that is told of a radiance.
template <class Value>
std::array<double, cause_count> differences(const ValidatedPixel& p, std::size_t half, Value&& value) {
    const double shown = value(p.shown), at_points = value(p.at_points),
                 true_at_points = value(glm::vec3(p.truth.at_points.halves[half])),
                 whole = value(glm::vec3(p.truth.whole.halves[half]));
    return {shown - at_points, at_points - true_at_points, true_at_points - whole, shown - whole};
}

double luminance_in_double(glm::vec3 radiance) {
    return glm::dot(glm::dvec3(core::luminance_weights), glm::dvec3(radiance));
}

/// Luminance that half of the pixels are below, by one half of their truth.
double median(std::span<const ValidatedPixel> pixels, std::size_t half) {
    std::vector<double> luminances;
    for (const ValidatedPixel& p : pixels) luminances.push_back(p.truth.whole.luminance_of(half));
    const auto middle = luminances.begin() + static_cast<std::ptrdiff_t>(luminances.size() / 2);
    std::nth_element(luminances.begin(), middle, luminances.end());
    return *middle;
}

/// Differences of a pixel against both halves, in all measures.
struct Differences {
    std::array<std::array<double, cause_count>, measure_count> of_half[2];

    Differences(const ValidatedPixel& p, const std::function<double(glm::vec3)>& luma) {
        for (std::size_t half = 0; half < 2; ++half) {
            auto& [luminance, relative, code_value] = of_half[half];
            luminance = differences(p, half, luminance_in_double);
            // Of the same half: its noise is in both, and independent of the other's.
            const double whole = std::max(p.truth.whole.luminance_of(half), static_cast<double>(p.least));
            for (std::size_t c = 0; c < cause_count; ++c) relative[c] = core::divide_or(luminance[c], whole, 0.0);
            code_value = code_errors(p, luma)[half];
        }
    }
};

/// Square of a value of which two independent estimates are known: the mean of their product.
struct Square {
    double value;
    void add_to(double& sum, double& squares) const {
        sum += value;
        squares += value * value;
    }
};

/// Sums over pixels of a block of 8x8: differences in code values against both halves.
struct Block {
    static constexpr int side = 8;
    int pixels = 0;
    std::array<std::array<double, cause_count>, 2> sums{};
};

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

CodeErrors code_errors(const ValidatedPixel& pixel, const std::function<double(glm::vec3)>& luma) {
    return {differences(pixel, 0, luma), differences(pixel, 1, luma)};
}

void ErrorSplit::add(std::span<const ValidatedPixel> pixels, const std::function<double(glm::vec3)>& luma) {
    if (pixels.empty()) return;
    const double middle[2] = {median(pixels, 0), median(pixels, 1)};
    std::map<std::pair<int, int>, Block> blocks;
    for (const ValidatedPixel& p : pixels) {
        // Each half says what is dark for the other: neither what the picture shows nor the noise of what is summed
        // must choose.
        const double dark[2] = {p.truth.whole.luminance_of(1) < middle[1] ? 0.5 : 0.0,
                                p.truth.whole.luminance_of(0) < middle[0] ? 0.5 : 0.0};
        ++sums_.pixels;
        sums_.paths += p.truth.paths;
        sums_.light += p.truth.whole.luminance();
        for (std::size_t half = 0; half < 2; ++half) sums_.dark_light += dark[half] * p.truth.whole.luminance_of(half);
        const Differences d(p, luma);
        Block& block = blocks[{p.place.y / Block::side, p.place.x / Block::side}];
        ++block.pixels;
        for (std::size_t half = 0; half < 2; ++half)
            for (std::size_t c = 0; c < cause_count; ++c)
                block.sums[half][c] += d.of_half[half][static_cast<std::size_t>(ErrorMeasure::code_value)][c];
        for (std::size_t c = 0; c < cause_count; ++c) {
            CauseSums& s = sums_.causes[c];
            const double one = d.of_half[0][0][c], other = d.of_half[1][0][c];
            const double difference = 0.5 * (one + other), dark_difference = dark[0] * one + dark[1] * other;
            s.difference += difference;
            s.difference_squares += difference * difference;
            s.dark_difference += dark_difference;
            s.dark_difference_squares += dark_difference * dark_difference;
            for (std::size_t m = 0; m < measure_count; ++m) {
                Square{d.of_half[0][m][c] * d.of_half[1][m][c]}.add_to(s.squares[m], s.square_squares[m]);
            }
        }
    }
    constexpr int whole = Block::side * Block::side;
    for (const auto& [place, block] : blocks) {
        if (block.pixels < whole) continue;
        ++sums_.blocks;
        for (std::size_t c = 0; c < cause_count; ++c) {
            CauseSums& s = sums_.causes[c];
            Square{block.sums[0][c] * block.sums[1][c] / (1.0 * whole * whole)}.add_to(s.block_squares,
                                                                                       s.block_square_squares);
        }
    }
}

void ErrorSplit::add_change(const CodeErrors& before, const CodeErrors& now) {
    ++sums_.followed;
    for (std::size_t c = 0; c < cause_count; ++c) {
        CauseSums& s = sums_.causes[c];
        Square{(now[0][c] - before[0][c]) * (now[1][c] - before[1][c])}.add_to(s.flicker_squares,
                                                                               s.flicker_square_squares);
    }
}

MeanError ErrorSplit::mean_square(ErrorCause cause, ErrorMeasure measure) const {
    const auto m = static_cast<std::size_t>(measure);
    return mean_of(of(cause).squares[m], of(cause).square_squares[m], sums_.pixels);
}

double ErrorSplit::rms(ErrorCause cause, ErrorMeasure measure) const {
    return core::sqrt_or_zero(mean_square(cause, measure).value);
}

MeanError ErrorSplit::block_mean_square(ErrorCause cause) const {
    return mean_of(of(cause).block_squares, of(cause).block_square_squares, sums_.blocks);
}

double ErrorSplit::block_rms(ErrorCause cause) const {
    return core::sqrt_or_zero(block_mean_square(cause).value);
}

MeanError ErrorSplit::flicker_mean_square(ErrorCause cause) const {
    return mean_of(of(cause).flicker_squares, of(cause).flicker_square_squares, sums_.followed);
}

double ErrorSplit::flicker(ErrorCause cause) const {
    return core::sqrt_or_zero(flicker_mean_square(cause).value);
}

MeanError ErrorSplit::bias(ErrorCause cause) const {
    const CauseSums& s = of(cause);
    return over_light(mean_of(s.difference, s.difference_squares, sums_.pixels), sums_.light, sums_.pixels);
}

MeanError ErrorSplit::dark_bias(ErrorCause cause) const {
    const CauseSums& s = of(cause);
    return over_light(mean_of(s.dark_difference, s.dark_difference_squares, sums_.pixels), sums_.dark_light,
                      sums_.pixels);
}

void ErrorSplit::add(const ErrorSplit& others) {
    sums_.pixels += others.sums_.pixels;
    sums_.paths += others.sums_.paths;
    sums_.blocks += others.sums_.blocks;
    sums_.followed += others.sums_.followed;
    sums_.light += others.sums_.light;
    sums_.dark_light += others.sums_.dark_light;
    for (std::size_t c = 0; c < cause_count; ++c) {
        CauseSums& sum = sums_.causes[c];
        const CauseSums& more = others.sums_.causes[c];
        sum.difference += more.difference;
        sum.difference_squares += more.difference_squares;
        sum.dark_difference += more.dark_difference;
        sum.dark_difference_squares += more.dark_difference_squares;
        sum.block_squares += more.block_squares;
        sum.block_square_squares += more.block_square_squares;
        sum.flicker_squares += more.flicker_squares;
        sum.flicker_square_squares += more.flicker_square_squares;
        for (std::size_t m = 0; m < measure_count; ++m) {
            sum.squares[m] += more.squares[m];
            sum.square_squares[m] += more.square_squares[m];
        }
    }
}

}  // namespace render2mpeg::renderer
