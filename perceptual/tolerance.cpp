#include "perceptual/tolerance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/isa_clones.h"

namespace render2mpeg::perceptual {
namespace {

constexpr int side = 8;

constexpr float half_a_code_value = 0.5f;

/// Weight of tolerances warped from earlier pictures. [Render2MPEG, 4.3]
constexpr float carried_weight = 0.5f;

/// Between which two of `count` centres of blocks a sample lies, and how far from the first to the second.
struct Between {
    int first, second;
    float t;
};

Between between_centres(int sample, int count) {
    const float place = (static_cast<float>(sample) + 0.5f) / side - 0.5f;
    const float clamped = std::clamp(place, 0.0f, static_cast<float>(count - 1));
    const int first = std::min(static_cast<int>(clamped), count - 1);
    return {first, std::min(first + 1, count - 1), clamped - static_cast<float>(first)};
}

/// Root mean squares of blocks, bilinear between their centres: an edge between two blocks is to show in no light.
core::Plane<float> interpolated(int width, int height, const core::Plane<float>& blocks) {
    core::Plane<float> plane(width, height);
    std::vector<float> row(static_cast<std::size_t>(blocks.width()));
    std::vector<Between> columns;
    for (int x = 0; x < width; ++x) columns.push_back(between_centres(x, blocks.width()));
    for (int y = 0; y < height; ++y) {
        const Between rows = between_centres(y, blocks.height());
        const float *upper = blocks.row(rows.first), *lower = blocks.row(rows.second);
        for (std::size_t i = 0; i < row.size(); ++i) row[i] = upper[i] + rows.t * (lower[i] - upper[i]);
        float* out = plane.row(y);
        for (int x = 0; x < width; ++x) {
            const Between& b = columns[static_cast<std::size_t>(x)];
            const float left = row[static_cast<std::size_t>(b.first)], right = row[static_cast<std::size_t>(b.second)];
            out[x] = left + b.t * (right - left);
        }
    }
    return plane;
}

}  // namespace

core::Plane<float> distances(int width, int height, const BlockErrors& errors) {
    core::Plane<float> blocks((width + side - 1) / side, (height + side - 1) / side);
    for (int row = 0; row < blocks.height(); ++row)
        for (int column = 0; column < blocks.width(); ++column)
            blocks.at(column, row) = root_mean_square(errors(column, row));
    return interpolated(width, height, blocks);
}

void to_tolerances(core::Plane<float>& distances, const PixelLight& light, const InverseLuma& display) {
    EXPECTS(distances.width() == light.width() && distances.height() == light.height());
    for (std::size_t i = 0; i < distances.size(); ++i) {
        float& d = distances.values()[i];
        const float luminance = light.luminance.values()[i];
        d = std::max(least_relative * luminance,
                     display.difference(light.luma.values()[i], luminance, light.exponent.values()[i],
                                        std::max(d, half_a_code_value)));
    }
}

void blend(core::Plane<float>& errors, const core::Plane<float>& before) {
    if (before.empty()) return;
    EXPECTS(before.width() == errors.width() && before.height() == errors.height());
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const float old = before.values()[i], own = errors.values()[i];
        errors.values()[i] = old > 0.0f ? own + carried_weight * (old - own) : own;
    }
}

}  // namespace render2mpeg::perceptual
