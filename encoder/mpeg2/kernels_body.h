#pragma once

// The loops behind kernels.h, included once per instruction set by a file that is compiled for it. Everything here has
// internal linkage, so that no function compiled for a newer processor can be linked into code that must run on an
// older one; for the same reason no other header with inline functions may be included.
//
// Vectors are the compiler's own (wider ones are split where the target lacks them): the same lanes and the same order
// of floating-point operations everywhere, hence the same numbers.

#include "encoder/mpeg2/kernels.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

using u8 = std::uint8_t;
using Stride = std::ptrdiff_t;
using U8x8 = u8 __attribute__((vector_size(8)));
using U8x16 = u8 __attribute__((vector_size(16)));
using I16x8 = std::int16_t __attribute__((vector_size(16)));
using I16x16 = std::int16_t __attribute__((vector_size(32)));
using I32x8 = std::int32_t __attribute__((vector_size(32)));
using F32x8 = float __attribute__((vector_size(32)));

#define R2M_INLINE inline __attribute__((always_inline))

template <class V, class T>
R2M_INLINE void load(V& v, const T* from) {
    __builtin_memcpy(&v, from, sizeof(V));
}
template <class V, class T>
R2M_INLINE void store(T* to, const V& v) {
    __builtin_memcpy(to, &v, sizeof(V));
}

// --- Differences
// ---------------------------------------------------------------------------------------------------------

R2M_INLINE void load_row_16(I16x16& v, const u8* from) {
    U8x16 bytes;
    load(bytes, from);
    v = __builtin_convertvector(bytes, I16x16);
}
R2M_INLINE void load_row_8(I32x8& v, const u8* from) {
    U8x8 bytes;
    load(bytes, from);
    v = __builtin_convertvector(bytes, I32x8);
}

R2M_INLINE std::int32_t sum_lanes(const I32x8& v) {
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

/// Hadamard butterflies of distance 4, 2 and (unless left to the caller) 1 over eight vectors.
R2M_INLINE void butterfly(I16x16& a, I16x16& b) {
    const I16x16 sum = a + b;
    b = a - b;
    a = sum;
}
R2M_INLINE void hadamard_but_last(I16x16 (&d)[8]) {
    for (int i = 0; i < 4; ++i) butterfly(d[i], d[i + 4]);
    for (int i = 0; i < 8; i += 4) {
        butterfly(d[i], d[i + 2]);
        butterfly(d[i + 1], d[i + 3]);
    }
}

/// Transposes the 8x8 block in the lower and the one in the upper half of eight vectors of 16 lanes.
R2M_INLINE void transpose_halves(I16x16 (&d)[8]) {
    I16x16 a[8], b[8];
    for (int i = 0; i < 4; ++i) {
        a[2 * i] = __builtin_shufflevector(d[i], d[i + 4], 0, 16, 1, 17, 2, 18, 3, 19, 8, 24, 9, 25, 10, 26, 11, 27);
        a[2 * i + 1] =
            __builtin_shufflevector(d[i], d[i + 4], 4, 20, 5, 21, 6, 22, 7, 23, 12, 28, 13, 29, 14, 30, 15, 31);
    }
    for (int i = 0; i < 4; ++i) {
        b[2 * i] = __builtin_shufflevector(a[i], a[i + 4], 0, 16, 1, 17, 2, 18, 3, 19, 8, 24, 9, 25, 10, 26, 11, 27);
        b[2 * i + 1] =
            __builtin_shufflevector(a[i], a[i + 4], 4, 20, 5, 21, 6, 22, 7, 23, 12, 28, 13, 29, 14, 30, 15, 31);
    }
    for (int i = 0; i < 4; ++i) {
        d[2 * i] = __builtin_shufflevector(b[i], b[i + 4], 0, 16, 1, 17, 2, 18, 3, 19, 8, 24, 9, 25, 10, 26, 11, 27);
        d[2 * i + 1] =
            __builtin_shufflevector(b[i], b[i + 4], 4, 20, 5, 21, 6, 22, 7, 23, 12, 28, 13, 29, 14, 30, 15, 31);
    }
}

R2M_INLINE I16x16 absolute(const I16x16& v) {
    const I16x16 negative = -v;
    return v > negative ? v : negative;
}

/// Sum of absolute Hadamard coefficients of two 8x8 blocks side by side. The last butterfly is |a + b| + |a - b| = 2
/// max(|a|, |b|): |a|, |b| <= 255 * 32, so that four of these maxima fit 16 bits.
R2M_INLINE std::int32_t satd_of_pair(I16x16 (&d)[8]) {
    hadamard_but_last(d);
    for (int i = 0; i < 8; i += 2) butterfly(d[i], d[i + 1]);
    transpose_halves(d);
    hadamard_but_last(d);
    I16x16 sum{};
    for (int i = 0; i < 8; i += 2) {
        const I16x16 a = absolute(d[i]), b = absolute(d[i + 1]);
        sum += a > b ? a : b;
    }
    const I16x8 low = __builtin_shufflevector(sum, sum, 0, 1, 2, 3, 4, 5, 6, 7);
    const I16x8 high = __builtin_shufflevector(sum, sum, 8, 9, 10, 11, 12, 13, 14, 15);
    return 2 * sum_lanes(__builtin_convertvector(low, I32x8) + __builtin_convertvector(high, I32x8));
}

std::uint32_t satd_16x16(const u8* a, Stride a_stride, const u8* b, Stride b_stride) {
    std::int32_t total = 0;
    for (int half = 0; half < 2; ++half) {
        I16x16 d[8];
        for (int y = 0; y < 8; ++y) {
            I16x16 p, q;
            load_row_16(p, a + (half * 8 + y) * a_stride);
            load_row_16(q, b + (half * 8 + y) * b_stride);
            d[y] = p - q;
        }
        total += satd_of_pair(d);
    }
    return static_cast<std::uint32_t>(total);
}

/// The DC of a block's Hadamard transform is the sum of its samples; with 128 taken off first everything fits 16 bits.
std::uint32_t activity_16x16(const u8* a, Stride stride) {
    std::int32_t total = 0;
    for (int half = 0; half < 2; ++half) {
        I16x16 d[8], sum{};
        for (int y = 0; y < 8; ++y) {
            load_row_16(d[y], a + (half * 8 + y) * stride);
            d[y] -= 128;
            sum += d[y];
        }
        std::int32_t left = 0, right = 0;
        for (int i = 0; i < 8; ++i) {
            left += sum[i];
            right += sum[8 + i];
        }
        total += satd_of_pair(d) - (left < 0 ? -left : left) - (right < 0 ? -right : right);
    }
    return static_cast<std::uint32_t>(total);
}

template <int size>
R2M_INLINE std::uint32_t ssd(const u8* a, Stride a_stride, const u8* b, Stride b_stride) {
    std::int32_t total = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const std::int16_t d = static_cast<std::int16_t>(a[y * a_stride + x] - b[y * b_stride + x]);
            total += d * d;
        }
    return static_cast<std::uint32_t>(total);
}
std::uint32_t ssd_16x16(const u8* a, Stride a_stride, const u8* b, Stride b_stride) {
    return ssd<16>(a, a_stride, b, b_stride);
}
std::uint32_t ssd_8x8(const u8* a, Stride a_stride, const u8* b, Stride b_stride) {
    return ssd<8>(a, a_stride, b, b_stride);
}

std::uint32_t sad_8x8(const u8* a, Stride a_stride, const u8* b, Stride b_stride) {
    I32x8 sum{};
    for (int y = 0; y < 8; ++y) {
        I32x8 p, q;
        load_row_8(p, a + y * a_stride);
        load_row_8(q, b + y * b_stride);
        const I32x8 d = p - q, n = q - p;
        sum += d > n ? d : n;
    }
    return static_cast<std::uint32_t>(sum_lanes(sum));
}

// --- Prediction
// ----------------------------------------------------------------------------------------------------------

template <int size>
R2M_INLINE void predict(u8* out, Stride out_stride, const u8* r, Stride stride, int half) {
    switch (half) {
        case 0:
            for (int y = 0; y < size; ++y) __builtin_memcpy(out + y * out_stride, r + y * stride, size);
            break;
        case 1:
        case 2: {
            const Stride next = half == 1 ? 1 : stride;
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const u8* s = r + y * stride + x;
                    out[y * out_stride + x] = static_cast<u8>((s[0] + s[next] + 1) >> 1);
                }
            break;
        }
        default:
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const u8* s = r + y * stride + x;
                    out[y * out_stride + x] = static_cast<u8>((s[0] + s[1] + s[stride] + s[stride + 1] + 2) >> 2);
                }
    }
}
void predict_16x16(u8* __restrict out, Stride out_stride, const u8* __restrict r, Stride stride, int half) {
    predict<16>(out, out_stride, r, stride, half);
}
void predict_8x8(u8* __restrict out, Stride out_stride, const u8* __restrict r, Stride stride, int half) {
    predict<8>(out, out_stride, r, stride, half);
}

// --- Transforms
// ----------------------------------------------------------------------------------------------------------

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

void forward_dct(float* coefficients, const u8* samples, Stride stride) {
    F32x8 x[8];
    for (int y = 0; y < 8; ++y) {
        I32x8 s;
        load_row_8(s, samples + y * stride);
        x[y] = __builtin_convertvector(s, F32x8);
    }
    forward_both(x, coefficients);
}

void forward_dct_of_difference(float* coefficients, const u8* samples, Stride stride, const u8* prediction,
                               Stride prediction_stride) {
    F32x8 x[8];
    for (int y = 0; y < 8; ++y) {
        I32x8 s, p;
        load_row_8(s, samples + y * stride);
        load_row_8(p, prediction + y * prediction_stride);
        x[y] = __builtin_convertvector(s - p, F32x8);
    }
    forward_both(x, coefficients);
}

// Constants of libavcodec's `simple` transform: round(cos(k pi / 16) sqrt(2) 2^14), but one less for k = 4, which is
// what makes the shortcut below differ from the full sum. Facts a decoder must share; the arithmetic is exact in 32
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

R2M_INLINE void store_clipped(u8* out, I32x8 v) {
    const I32x8 low{};
    const I32x8 high = low + 255;
    v = v < low ? low : v;
    v = v > high ? high : v;
    store(out, __builtin_convertvector(v, U8x8));
}

void inverse_dct_put(const std::int16_t* coefficients, u8* out, Stride stride) {
    I32x8 x[8];
    inverse_both(coefficients, x);
    for (int y = 0; y < 8; ++y) store_clipped(out + y * stride, x[y]);
}

void inverse_dct_add(const std::int16_t* coefficients, u8* out, Stride stride) {
    I32x8 x[8];
    inverse_both(coefficients, x);
    for (int y = 0; y < 8; ++y) {
        I32x8 p;
        load_row_8(p, out + y * stride);
        store_clipped(out + y * stride, x[y] + p);
    }
}

// --- Quantisation
// --------------------------------------------------------------------------------------------------------

Quantised quantise(const float* coefficients, const QuantTable& table, std::int16_t* levels,
                   std::int16_t* dequantised) {
    const I32x8 zero{};
    const F32x8 zero_f{};
    F32x8 distortion{}, energy{};
    std::uint64_t nonzero = 0;
    for (int u = 0; u < 8; ++u) {
        F32x8 c, reciprocal;
        I32x8 weight, highest;
        load(c, coefficients + u * 8);
        load(reciprocal, table.reciprocal + u * 8);
        load(weight, table.weight + u * 8);
        load(highest, table.highest + u * 8);

        const F32x8 magnitude = c < zero_f ? -c : c;
        I32x8 level = __builtin_convertvector(magnitude * reciprocal + table.rounding, I32x8);
        level = level > highest ? highest : level;
        I32x8 value = ((level * 2 + table.reconstruction) * weight) >> 4;
        value = level == zero ? zero : value;
        const F32x8 error = magnitude - __builtin_convertvector(value, F32x8);
        distortion += error * error;
        energy += c * c;

        const I32x8 negative = c < zero_f;
        store(levels + u * 8, __builtin_convertvector(negative != zero ? -level : level, I16x8));
        store(dequantised + u * 8, __builtin_convertvector(negative != zero ? -value : value, I16x8));
        const I32x8 bits = (level != zero) & I32x8{1, 2, 4, 8, 16, 32, 64, 128};
        nonzero |= static_cast<std::uint64_t>(static_cast<std::uint32_t>(sum_lanes(bits))) << (u * 8);
    }
    const auto sum = [](const F32x8& v) { return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7])); };
    return {nonzero, sum(distortion), sum(energy)};
}

constexpr Kernels all_kernels = {satd_16x16,  activity_16x16,  ssd_16x16,
                                 ssd_8x8,     sad_8x8,         predict_16x16,
                                 predict_8x8, forward_dct,     forward_dct_of_difference,
                                 quantise,    inverse_dct_put, inverse_dct_add};

#undef R2M_INLINE

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
