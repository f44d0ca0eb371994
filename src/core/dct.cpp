#include "core/dct.h"

#include <cmath>
#include <numbers>

#include "core/isa_clones.h"

namespace render2mpeg::core {
namespace {

/// basis.value[u][x] = c(u) cos((2x + 1) u pi / 16), orthonormal rows; `turned` is its transpose.
struct Basis {
    float value[8][8], turned[8][8];
    Basis() {
        for (int u = 0; u < 8; ++u)
            for (int x = 0; x < 8; ++x)
                turned[x][u] = value[u][x] = static_cast<float>(std::sqrt(u == 0 ? 0.125 : 0.25) *
                                                                std::cos((2 * x + 1) * u * std::numbers::pi / 16));
    }
};

const Basis basis;

/// out = a b, 8x8 each: sums run over the inner index in order, eight columns side by side.
RENDER2MPEG_ALWAYS_INLINED void multiply(const float* __restrict a, const float* __restrict b, float* __restrict out) {
    for (int row = 0; row < 8; ++row) {
        float sum[8] = {};
        for (int k = 0; k < 8; ++k)
            for (int column = 0; column < 8; ++column) sum[column] += a[8 * row + k] * b[8 * k + column];
        for (int column = 0; column < 8; ++column) out[8 * row + column] = sum[column];
    }
}

}  // namespace

RENDER2MPEG_CLONES
Block8x8 forward_dct(const Block8x8& samples) {
    Block8x8 rows, result;
    multiply(samples.data(), basis.turned[0], rows.data());
    multiply(basis.value[0], rows.data(), result.data());
    return result;
}

RENDER2MPEG_CLONES
Block8x8 inverse_dct(const Block8x8& coefficients) {
    Block8x8 columns, result;
    multiply(basis.turned[0], coefficients.data(), columns.data());
    multiply(columns.data(), basis.value[0], result.data());
    return result;
}

}  // namespace render2mpeg::core
