#pragma once

// Differences and prediction; see kernels_body.h.

#include "encoder/mpeg2/kernels_vectors.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

// --- Differences
// ---------------------------------------------------------------------------------------------------------

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
    return 2 * sum_lanes(sum);
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
    I16x16 sum{};
    for (int y = 0; y < 8; y += 2) {
        I16x16 p, q;
        load_two_rows_of_8(p, a + y * a_stride, a_stride);
        load_two_rows_of_8(q, b + y * b_stride, b_stride);
        sum += absolute(p - q);
    }
    return static_cast<std::uint32_t>(sum_lanes(sum));
}

// --- Prediction ------------------------------------------------------------------------------------------------------

/// (a + b + 1) / 2 of two neighbours; a form that compilers turn into one instruction for 16 or 8 samples.
template <int size>
R2M_INLINE void predict_between_two(u8* out, Stride out_stride, const u8* r, Stride stride, Stride next) {
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const u8* s = r + y * stride + x;
            out[y * out_stride + x] = static_cast<u8>((s[0] + s[next] + 1) >> 1);
        }
}

R2M_INLINE void add_neighbour_16(I16x16& sum, const u8* from) {
    I16x16 a, b;
    load_row_16(a, from);
    load_row_16(b, from + 1);
    sum = a + b;
}

void predict_16x16(u8* __restrict out, Stride out_stride, const u8* __restrict r, Stride stride, int half) {
    if (half == 0) {
        for (int y = 0; y < 16; ++y) __builtin_memcpy(out + y * out_stride, r + y * stride, 16);
    } else if (half < 3) {
        predict_between_two<16>(out, out_stride, r, stride, half == 1 ? 1 : stride);
    } else {
        I16x16 above, below;
        add_neighbour_16(above, r);
        for (int y = 0; y < 16; ++y) {
            add_neighbour_16(below, r + (y + 1) * stride);
            store(out + y * out_stride, __builtin_convertvector((above + below + 2) >> 2, U8x16));
            above = below;
        }
    }
}

void predict_8x8(u8* __restrict out, Stride out_stride, const u8* __restrict r, Stride stride, int half) {
    if (half == 0) {
        for (int y = 0; y < 8; ++y) __builtin_memcpy(out + y * out_stride, r + y * stride, 8);
    } else if (half < 3) {
        predict_between_two<8>(out, out_stride, r, stride, half == 1 ? 1 : stride);
    } else {
        for (int y = 0; y < 8; y += 2) {
            I16x16 sum, more;
            load_two_rows_of_8(sum, r + y * stride, stride);
            const Stride nexts[] = {1, stride, stride + 1};
            for (const Stride next : nexts) {
                load_two_rows_of_8(more, r + y * stride + next, stride);
                sum += more;
            }
            store_two_rows_of_8(out + y * out_stride, out_stride, (sum + 2) >> 2);
        }
    }
}

void average(u8* __restrict a, const u8* __restrict b, int count) {
    for (int at = 0; at < count; at += 32)
        for (int i = 0; i < 32; ++i) a[at + i] = static_cast<u8>((a[at + i] + b[at + i] + 1) >> 1);
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
