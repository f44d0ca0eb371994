#pragma once

// Transforms; see kernels_body.h.

#include "encoder/mpeg2/kernels/kernels_vectors.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

// Transforms

template <class V>
R2M_INLINE void transpose(V (&r)[8]) {
    V a[8], b[8];
    for (int i = 0; i < 8; i += 2) {
        a[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        a[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int i = 0; i < 8; i += 4)
        for (int k = 0; k < 2; ++k) {
            b[i + k] = __builtin_shufflevector(a[i + k], a[i + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            b[i + k + 2] = __builtin_shufflevector(a[i + k], a[i + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (int k = 0; k < 4; ++k) {
        r[k] = __builtin_shufflevector(b[k], b[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        r[k + 4] = __builtin_shufflevector(b[k], b[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

/// One-dimensional orthonormal DCT-II over eight vectors, by even and odd parts; c_k = cos(k pi / 16) / 2.
R2M_INLINE void forward_pass(F32x8 (&x)[8]) {
    constexpr float c1 = 0.490392640f, c2 = 0.461939766f, c3 = 0.415734806f, c4 = 0.353553391f, c5 = 0.277785117f,
                    c6 = 0.191341716f, c7 = 0.097545161f;
    const F32x8 s0 = x[0] + x[7], s1 = x[1] + x[6], s2 = x[2] + x[5], s3 = x[3] + x[4];
    const F32x8 d0 = x[0] - x[7], d1 = x[1] - x[6], d2 = x[2] - x[5], d3 = x[3] - x[4];
    const F32x8 e0 = s0 + s3, e1 = s1 + s2, e2 = s0 - s3, e3 = s1 - s2;
    x[0] = (e0 + e1) * c4;
    x[4] = (e0 - e1) * c4;
    x[2] = e2 * c2 + e3 * c6;
    x[6] = e2 * c6 - e3 * c2;
    x[1] = (d0 * c1 + d1 * c3) + (d2 * c5 + d3 * c7);
    x[3] = (d0 * c3 - d1 * c7) - (d2 * c1 + d3 * c5);
    x[5] = (d0 * c5 - d1 * c1) + (d2 * c7 + d3 * c3);
    x[7] = (d0 * c7 - d1 * c5) + (d2 * c3 - d3 * c1);
}

R2M_INLINE void forward_both(F32x8 (&x)[8], float* coefficients) {
    forward_pass(x);
    transpose(x);
    forward_pass(x);
    for (int u = 0; u < 8; ++u) store(coefficients + u * 8, x[u]);
}

R2M_INLINE void to_float(const I16x16& two_rows, F32x8& first, F32x8& second) {
    first = __builtin_convertvector(widen(lower_half(two_rows)), F32x8);
    second = __builtin_convertvector(widen(upper_half(two_rows)), F32x8);
}

void forward_dct(float* coefficients, const u8* samples, Stride stride) {
    F32x8 x[8];
    for (int y = 0; y < 8; y += 2) {
        I16x16 s;
        load_two_rows_of_8(s, samples + y * stride, stride);
        to_float(s, x[y], x[y + 1]);
    }
    forward_both(x, coefficients);
}

void forward_dct_of_difference(float* coefficients, const u8* samples, Stride stride, const u8* prediction,
                               Stride prediction_stride) {
    F32x8 x[8];
    for (int y = 0; y < 8; y += 2) {
        I16x16 s, p;
        load_two_rows_of_8(s, samples + y * stride, stride);
        load_two_rows_of_8(p, prediction + y * prediction_stride, prediction_stride);
        to_float(s - p, x[y], x[y + 1]);
    }
    forward_both(x, coefficients);
}

// Constants of libavcodec's `simple` transform: round(cos(k pi / 16) sqrt(2) 2^14), but one less for k = 4, which makes
// the shortcut below differ from the full sum. A decoder must share these constants; the arithmetic is exact in 32
// bits.
constexpr std::int32_t w1 = 22725, w2 = 21407, w3 = 19266, w4 = 16383, w5 = 12873, w6 = 8867, w7 = 4520;
constexpr int row_shift = 11, column_shift = 20, dc_shift = 3;

/// One pass over eight vectors; `a` starts as w4 * first + rounding.
template <int shift>
R2M_INLINE void inverse_pass(I32x8 (&x)[8], const I32x8& start) {
    const I32x8 c4 = x[4] * w4, c2a = x[2] * w2, c2b = x[2] * w6, c6a = x[6] * w6, c6b = x[6] * w2;
    const I32x8 p = start + c4, m = start - c4;
    const I32x8 a0 = p + (c2a + c6a), a3 = p - (c2a + c6a), a1 = m + (c2b - c6b), a2 = m - (c2b - c6b);
    const I32x8 b0 = (x[1] * w1 + x[3] * w3) + (x[5] * w5 + x[7] * w7);
    const I32x8 b1 = (x[1] * w3 - x[3] * w7) - (x[5] * w1 + x[7] * w5);
    const I32x8 b2 = (x[1] * w5 - x[3] * w1) + (x[5] * w7 + x[7] * w3);
    const I32x8 b3 = (x[1] * w7 - x[3] * w5) + (x[5] * w3 - x[7] * w1);
    x[0] = (a0 + b0) >> shift;
    x[7] = (a0 - b0) >> shift;
    x[1] = (a1 + b1) >> shift;
    x[6] = (a1 - b1) >> shift;
    x[2] = (a2 + b2) >> shift;
    x[5] = (a2 - b2) >> shift;
    x[3] = (a3 + b3) >> shift;
    x[4] = (a3 - b3) >> shift;
}

R2M_INLINE void inverse_both(const std::int16_t* coefficients, I32x8 (&x)[8]) {
    // Transform rows, eight at a time. A row with nothing but its first coefficient is that times 8.
    I32x8 ac{};
    for (int u = 0; u < 8; ++u) {
        I16x8 c;
        load(c, coefficients + u * 8);
        x[u] = __builtin_convertvector(c, I32x8);
        if (u > 0) ac |= x[u];
    }
    const I32x8 flat = x[0] << dc_shift;
    const I32x8 zero{};
    inverse_pass<row_shift>(x, x[0] * w4 + (1 << (row_shift - 1)));
    for (int i = 0; i < 8; ++i) x[i] = ac == zero ? flat : x[i];

    // Transform columns.
    transpose(x);
    inverse_pass<column_shift>(x, (x[0] + ((1 << (column_shift - 1)) / w4)) * w4);
}

/// Clips two rows to bytes. Results of the transform lie within 2^31 / 2^20: 16 bits hold them, and a sample more.
R2M_INLINE void store_clipped(u8* out, Stride stride, I16x16 two_rows) {
    const I16x16 low{};
    const I16x16 high = low + 255;
    two_rows = two_rows < low ? low : two_rows;
    two_rows = two_rows > high ? high : two_rows;
    store_two_rows_of_8(out, stride, two_rows);
}
R2M_INLINE I16x16 narrow(const I32x8& first, const I32x8& second) {
    return __builtin_shufflevector(__builtin_convertvector(first, I16x8), __builtin_convertvector(second, I16x8), 0, 1,
                                   2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

void inverse_dct_put(const std::int16_t* coefficients, u8* out, Stride stride) {
    I32x8 x[8];
    inverse_both(coefficients, x);
    for (int y = 0; y < 8; y += 2) store_clipped(out + y * stride, stride, narrow(x[y], x[y + 1]));
}

void inverse_dct_add(const std::int16_t* coefficients, u8* out, Stride stride) {
    I32x8 x[8];
    inverse_both(coefficients, x);
    for (int y = 0; y < 8; y += 2) {
        I16x16 p;
        load_two_rows_of_8(p, out + y * stride, stride);
        store_clipped(out + y * stride, stride, p + narrow(x[y], x[y + 1]));
    }
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
