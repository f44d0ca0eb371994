#include "renderer/view/exposure_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>

#include "core/error.h"

namespace render2mpeg::renderer {
namespace {

/// Ranks of the fractional parts of multiples of a number: a permutation that is even in every run of samples.
std::vector<int> ranks(int samples, double step) {
    std::vector<double> values;
    for (int s = 0; s < samples; ++s) values.push_back(s * step - std::floor(s * step));
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<int> rank(values.size());
    for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = static_cast<int>(k);
    return rank;
}

/// fit: docs/measurements.md#shutter-and-lens, sqrt(2) - 1 of seven.
constexpr double lens_step = 0.41421356;

constexpr double golden_angle = 2.39996322972865332;

}  // namespace

int dither_class(int x, int y) {
    constexpr std::array<int, dither_classes> matrix{0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    return matrix[static_cast<std::size_t>(y % dither_side * dither_side + x % dither_side)];
}

ExposurePattern::ExposurePattern(int samples) : lens_rank_(ranks(samples, lens_step)) {
    EXPECTS(samples >= 1);
}

float ExposurePattern::time(int sample, int dither) const {
    const float within = (static_cast<float>(dither) + 0.5f) / dither_classes;
    // In the order of the places in the pixel, which are even in every run of samples [Roberts2018].
    return (static_cast<float>(sample) + within) / static_cast<float>(samples());
}

glm::vec2 ExposurePattern::lens(int sample, int dither, const scene::CameraLens& lens) const {
    // A spiral by the golden angle: equal areas, whatever the number of samples [Vogel1979].
    const int rank = lens_rank_[static_cast<std::size_t>(sample)];
    const double share = (rank + (dither + 0.5) / dither_classes) / samples();
    const double turn = rank * golden_angle / (2 * glm::pi<double>()) + static_cast<double>(dither) / dither_classes;
    const double around = turn - std::floor(turn), radius = std::sqrt(share);
    glm::dvec2 place;
    if (lens.blades >= 3) {
        // A triangle of the polygon, and a point of it.
        const double side = around * lens.blades, first = std::floor(side), along = side - first;
        const auto corner = [&](double k) {
            const double angle = static_cast<double>(lens.blade_rotation) + 2 * glm::pi<double>() * k / lens.blades;
            return glm::dvec2(std::cos(angle), std::sin(angle));
        };
        place = radius * ((1 - along) * corner(first) + along * corner(first + 1));
    } else {
        const double angle = 2 * glm::pi<double>() * around;
        place = radius * glm::dvec2(std::cos(angle), std::sin(angle));
    }
    return glm::vec2(place / glm::dvec2(static_cast<double>(lens.squeeze), 1.0));
}

}  // namespace render2mpeg::renderer
