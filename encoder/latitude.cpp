#include "encoder/latitude.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "encoder/codec.h"

namespace render2mpeg::encoder {
std::vector<float> weights_of_rows(const Settings& settings) {
    std::vector<float> weights;
    if (!settings.sphere) return weights;
    const int height = settings.packing == core::FramePacking::top_bottom ? settings.height / 2 : settings.height;
    const double shown = 1 - settings.sphere->top - settings.sphere->bottom;
    for (int y = 0; y < settings.height; ++y) {
        const double from_top =
            settings.sphere->top + shown * (std::min(y % std::max(height, 1), height - 1) + 0.5) / height;
        weights.push_back(static_cast<float>(std::sin(std::numbers::pi * from_top)));
    }
    return weights;
}

float latitude_factor(float weight) {
    // chosen: 4, beyond 86.4 degrees of latitude, where two thousandths of the sphere are.
    constexpr float most = 4;
    return std::min(1 / std::sqrt(std::max(weight, 1e-6f)), most);
}

core::Plane<float> latitude_factors(const Settings& settings) {
    const std::vector<float> weights = weights_of_rows(settings);
    if (weights.empty() || !facts_of(settings.codec).takes_blocks) return {};
    core::Plane<float> factors((settings.width + 15) / 16, (settings.height + 15) / 16);
    for (int row = 0; row < factors.height(); ++row) {
        const auto first = weights.begin() + 16 * row, end = weights.begin() + std::min(16 * row + 16, settings.height);
        const float mean = std::accumulate(first, end, 0.0f) / static_cast<float>(end - first);
        std::fill(factors.row(row), factors.row(row) + factors.width(), latitude_factor(mean));
    }
    return factors;
}

}  // namespace render2mpeg::encoder
