#pragma once

// Differences and prediction; see kernels_body.h.

#include "encoder/mpeg2/kernels/kernels_vectors.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

// Differences

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

#if defined(__AVX512BW__)

/// All four blocks at once: eight vectors of a row of 16 in the upper and one in the lower half of the macroblock.
R2M_INLINE void butterfly(__m512i& a, __m512i& b) {
    const __m512i sum = _mm512_add_epi16(a, b);
    b = _mm512_sub_epi16(a, b);
    a = sum;
}
R2M_INLINE void hadamard_but_last(__m512i (&d)[8]) {
    for (int i = 0; i < 4; ++i) butterfly(d[i], d[i + 4]);
    for (int i = 0; i < 8; i += 4) {
        butterfly(d[i], d[i + 2]);
        butterfly(d[i + 1], d[i + 3]);
    }
}
R2M_INLINE void interleave(const __m512i (&from)[8], __m512i (&to)[8]) {
    for (int i = 0; i < 4; ++i) {
        to[2 * i] = _mm512_unpacklo_epi16(from[i], from[i + 4]);
        to[2 * i + 1] = _mm512_unpackhi_epi16(from[i], from[i + 4]);
    }
}
R2M_INLINE __m512i load_rows(const u8* upper, Stride stride) {
    const __m128i a = _mm_loadu_si128(reinterpret_cast<const __m128i*>(upper));
    const __m128i b = _mm_loadu_si128(reinterpret_cast<const __m128i*>(upper + 8 * stride));
    return _mm512_cvtepu8_epi16(_mm256_inserti128_si256(_mm256_castsi128_si256(a), b, 1));
}
std::uint32_t satd_16x16(const u8* a, Stride a_stride, const u8* b, Stride b_stride) {
    __m512i d[8], t[8];
    for (int y = 0; y < 8; ++y)
        d[y] = _mm512_sub_epi16(load_rows(a + y * a_stride, a_stride), load_rows(b + y * b_stride, b_stride));
    hadamard_but_last(d);
    for (int i = 0; i < 8; i += 2) butterfly(d[i], d[i + 1]);
    interleave(d, t);
    interleave(t, d);
    interleave(d, t);
    hadamard_but_last(t);
    __m512i sum = _mm512_setzero_si512();
    for (int i = 0; i < 8; i += 2)
        sum = _mm512_add_epi16(sum, _mm512_max_epi16(_mm512_abs_epi16(t[i]), _mm512_abs_epi16(t[i + 1])));
    // Four of them reach 2^15: they have no sign.
    const __m512i zero = _mm512_setzero_si512();
    const __m512i wide = _mm512_add_epi32(_mm512_unpacklo_epi16(sum, zero), _mm512_unpackhi_epi16(sum, zero));
    const auto lanes = reinterpret_cast<I32x16>(wide);
    return static_cast<std::uint32_t>(2 *
                                      sum_lanes(__builtin_shufflevector(lanes, lanes, 0, 1, 2, 3, 4, 5, 6, 7) +
                                                __builtin_shufflevector(lanes, lanes, 8, 9, 10, 11, 12, 13, 14, 15)));
}

#else

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

#endif

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

std::uint32_t sad_16x16(const u8* a, Stride a_stride, const u8* b, Stride b_stride) {
    Sums sums{};
    for (int y = 0; y < 16; ++y) sums += absolute_differences(load_16(a + y * a_stride), load_16(b + y * b_stride));
    return add_lanes(sums);
}

// Prediction

/// Sixteen samples of a prediction, row by row; `half` as in kernels.h. The mean of four rounds its halves up:
/// (a + b + c + d + 2) / 4 is the mean of the two means, less one where those differ in their last bit and one of them
/// was rounded.
template <int half>
class HalfPel {
  public:
    HalfPel(const u8* reference, Stride stride) : at_(reference), stride_(stride) {
        if (half == 3) start();
    }
    R2M_INLINE U8x16 next() {
        const u8* here = at_;
        at_ += stride_;
        if (half == 0) return load_16(here);
        if (half == 1) return mean_up(load_16(here), load_16(here + 1));
        if (half == 2) return mean_up(load_16(here), load_16(at_));
        const U8x16 above = mean_, above_rounded = rounded_;
        start();
        const U8x16 one = (above ^ above) + 1;
        return mean_up(above, mean_) - ((above_rounded | rounded_) & (above ^ mean_) & one);
    }

  private:
    R2M_INLINE void start() {
        const U8x16 a = load_16(at_), b = load_16(at_ + 1);
        mean_ = mean_up(a, b);
        rounded_ = a ^ b;
    }
    const u8* at_;
    Stride stride_;
    U8x16 mean_{}, rounded_{};  ///< of the row above, half 3 only
};

template <int half>
R2M_INLINE void predict_16_rows(u8* out, Stride out_stride, const u8* reference, Stride stride) {
    HalfPel<half> rows(reference, stride);
    for (int y = 0; y < 16; ++y) store(out + y * out_stride, rows.next());
}
void predict_16x16(u8* __restrict out, Stride out_stride, const u8* __restrict r, Stride stride, int half) {
    if (half == 0) return predict_16_rows<0>(out, out_stride, r, stride);
    if (half == 1) return predict_16_rows<1>(out, out_stride, r, stride);
    if (half == 2) return predict_16_rows<2>(out, out_stride, r, stride);
    predict_16_rows<3>(out, out_stride, r, stride);
}

/// Eight samples of a row and eight of the next one.
R2M_INLINE U8x16 load_8_and_8(const u8* from, Stride stride) {
    std::uint64_t rows[2];
    __builtin_memcpy(&rows[0], from, 8);
    __builtin_memcpy(&rows[1], from + stride, 8);
    U8x16 v;
    load(v, rows);
    return v;
}
R2M_INLINE void store_8_and_8(u8* to, Stride stride, const U8x16& v) {
    std::uint64_t rows[2];
    store(rows, v);
    __builtin_memcpy(to, &rows[0], 8);
    __builtin_memcpy(to + stride, &rows[1], 8);
}

void predict_8x8(u8* __restrict out, Stride out_stride, const u8* __restrict r, Stride stride, int half) {
    if (half == 0) {
        for (int y = 0; y < 8; ++y) __builtin_memcpy(out + y * out_stride, r + y * stride, 8);
    } else if (half < 3) {
        const Stride next = half == 1 ? 1 : stride;
        for (int y = 0; y < 8; y += 2)
            store_8_and_8(out + y * out_stride, out_stride,
                          mean_up(load_8_and_8(r + y * stride, stride), load_8_and_8(r + y * stride + next, stride)));
    } else {
        for (int y = 0; y < 8; y += 2) {
            const u8* here = r + y * stride;
            const U8x16 a = load_8_and_8(here, stride), b = load_8_and_8(here + 1, stride);
            const U8x16 c = load_8_and_8(here + stride, stride), d = load_8_and_8(here + stride + 1, stride);
            const U8x16 above = mean_up(a, b), below = mean_up(c, d), one = (a ^ a) + 1;
            store_8_and_8(out + y * out_stride, out_stride,
                          mean_up(above, below) - (((a ^ b) | (c ^ d)) & (above ^ below) & one));
        }
    }
}

void average(u8* __restrict a, const u8* __restrict b, int count) {
    for (int at = 0; at < count; at += 16) store(a + at, mean_up(load_16(a + at), load_16(b + at)));
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
