#include "renderer/surface/sheen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace render2mpeg::renderer {
namespace {

constexpr int steps = 16;
constexpr double least_roughness = 0.1;

/// The fit of facets' shadowing [KHR_materials_sheen, "Sheen Visibility"].
double shadow_fit(double x, double alpha) {
    const double t = (1 - alpha) * (1 - alpha);
    const double a = std::lerp(21.5473, 25.3245, t), b = std::lerp(3.82987, 3.32435, t),
                 c = std::lerp(0.19823, 0.16801, t), d = std::lerp(-1.97760, -1.27393, t),
                 e = std::lerp(-4.32054, -4.85967, t);
    return a / (1 + b * std::pow(x, c)) + d * x + e;
}

double shadowing(double cosine, double alpha) {
    return cosine < 0.5 ? std::exp(shadow_fit(cosine, alpha))
                        : std::exp(2 * shadow_fit(0.5, alpha) - shadow_fit(1 - cosine, alpha));
}

/// D V cos at light of this cosine, `across` the cosine of its azimuth to the eye.
double sent(double nv, double nl, double across, double alpha) {
    const double vl = nv * nl + std::sqrt((1 - nv * nv) * (1 - nl * nl)) * across;
    const double nh2 = std::min(1.0, (nv + nl) * (nv + nl) / std::max(1e-12, 2 + 2 * vl));
    const double d = (2 + 1 / alpha) * std::pow(std::sqrt(1 - nh2), 1 / alpha) / (2 * std::numbers::pi);
    const double v = 1 / ((1 + shadowing(nv, alpha) + shadowing(nl, alpha)) * 4 * nv * nl);
    return d * std::min(v, 1.0) * nl;
}

double integral(double nv, double alpha) {
    constexpr int heights = 64, turns = 32;
    double sum = 0;
    for (int i = 0; i < heights; ++i)
        for (int k = 0; k < turns; ++k)
            sum += sent(nv, (i + 0.5) / heights, std::cos(std::numbers::pi * (k + 0.5) / turns), alpha);
    return sum * 2 * std::numbers::pi / (heights * turns);
}

using SheenTable = std::array<std::array<float, steps>, steps>;

double roughness_of(int row) {
    return least_roughness + (1 - least_roughness) * row / (steps - 1);
}

const SheenTable& sheen_table() {
    static const SheenTable table = [] {
        SheenTable made{};
        for (int row = 0; row < steps; ++row)
            for (int column = 0; column < steps; ++column) {
                const double alpha = roughness_of(row) * roughness_of(row), x = column / (steps - 1.0);
                made[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] =
                    static_cast<float>(integral(std::max(x * x, 1e-3), alpha));
            }
        return made;
    }();
    return table;
}

}  // namespace

float sheen_albedo(float cosine, float roughness) {
    const SheenTable& table = sheen_table();
    const float last = steps - 1;
    // Columns by the square root of the cosine: most happens at grazing angles.
    const float x = last * std::sqrt(std::clamp(cosine, 0.0f, 1.0f));
    const float low = static_cast<float>(least_roughness);
    const float y = last * std::clamp((roughness - low) / (1 - low), 0.0f, 1.0f);
    const auto i = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(steps - 2));
    const auto j = std::min(static_cast<std::size_t>(y), static_cast<std::size_t>(steps - 2));
    const float u = x - static_cast<float>(i), v = y - static_cast<float>(j);
    return std::lerp(std::lerp(table[j][i], table[j][i + 1], u), std::lerp(table[j + 1][i], table[j + 1][i + 1], u), v);
}

float microfibre_albedo(float cosine, float roughness) {
    // Rows by powers of the root of the cosine, columns by those of the roughness' logarithm.
    // fit: docs/measurements.md#sheen
    constexpr float least_cosine = 0.07f;
    constexpr float fit[4][5] = {{-0.24599f, 0.11867f, 1.54161f, 1.57089f, 0.37322f},
                                 {-0.02203f, 1.06486f, -7.85481f, -8.43702f, -1.32535f},
                                 {-0.98602f, -1.91244f, 12.48337f, 10.76954f, -1.7314f},
                                 {0.17216f, 3.32821f, -7.26352f, -0.57333f, 4.23538f}};
    const float u = std::sqrt(std::clamp(cosine, least_cosine, 1.0f));
    const float v = std::log(std::clamp(roughness, static_cast<float>(least_roughness), 1.0f));
    float sum = 0;
    for (int i = 3; i >= 0; --i) {
        float row = 0;
        for (int j = 4; j >= 0; --j) row = row * v + fit[i][j];
        sum = sum * u + row;
    }
    return std::min(std::exp(sum), 1.0f);
}

}  // namespace render2mpeg::renderer
