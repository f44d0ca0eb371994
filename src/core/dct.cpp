#include "core/dct.h"

#include <cmath>
#include <numbers>

namespace render2mpeg::core {
namespace {

/// basis[u][x] = c(u) cos((2x + 1) u pi / 16), orthonormal rows.
struct Basis {
    float value[8][8];
    Basis() {
        for (int u = 0; u < 8; ++u)
            for (int x = 0; x < 8; ++x)
                value[u][x] = static_cast<float>(std::sqrt(u == 0 ? 0.125 : 0.25) *
                                                 std::cos((2 * x + 1) * u * std::numbers::pi / 16));
    }
};

const Basis basis;

}  // namespace

Block8x8 forward_dct(const Block8x8& samples) {
    Block8x8 rows{}, result{};
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int u = 0; u < 8; ++u) rows[y * 8 + u] += samples[y * 8 + x] * basis.value[u][x];
    for (int v = 0; v < 8; ++v)
        for (int y = 0; y < 8; ++y)
            for (int u = 0; u < 8; ++u) result[v * 8 + u] += rows[y * 8 + u] * basis.value[v][y];
    return result;
}

Block8x8 inverse_dct(const Block8x8& coefficients) {
    Block8x8 columns{}, result{};
    for (int v = 0; v < 8; ++v)
        for (int y = 0; y < 8; ++y)
            for (int u = 0; u < 8; ++u) columns[y * 8 + u] += coefficients[v * 8 + u] * basis.value[v][y];
    for (int y = 0; y < 8; ++y)
        for (int u = 0; u < 8; ++u)
            for (int x = 0; x < 8; ++x) result[y * 8 + x] += columns[y * 8 + u] * basis.value[u][x];
    return result;
}

}  // namespace render2mpeg::core
