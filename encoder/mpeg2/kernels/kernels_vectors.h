#pragma once

// Vectors of the compiler's own kind, for kernels_body.h alone.

#include "encoder/mpeg2/kernels/kernels.h"

#if defined(__AVX512BW__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>  // functions of these headers are always inlined and never emitted
#endif

namespace render2mpeg::encoder::mpeg2 {
namespace {

using u8 = std::uint8_t;
using Stride = std::ptrdiff_t;
using U8x8 = u8 __attribute__((vector_size(8)));
using U8x16 = u8 __attribute__((vector_size(16)));
using I16x8 = std::int16_t __attribute__((vector_size(16)));
using I16x16 = std::int16_t __attribute__((vector_size(32)));
using I32x8 = std::int32_t __attribute__((vector_size(32)));
#if defined(__AVX512BW__)
using I32x16 = std::int32_t __attribute__((vector_size(64)));
#endif
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

R2M_INLINE void load_row_16(I16x16& v, const u8* from) {
    U8x16 bytes;
    load(bytes, from);
    v = __builtin_convertvector(bytes, I16x16);
}
/// Sixteen samples: the mean of two, rounded up, and the sum of absolute differences have instructions of their own.
R2M_INLINE U8x16 load_16(const u8* from) {
    U8x16 v;
    load(v, from);
    return v;
}
R2M_INLINE U8x16 mean_up(const U8x16& a, const U8x16& b) {
#if defined(__SSE2__)
    return reinterpret_cast<U8x16>(_mm_avg_epu8(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
    return (a | b) - ((a ^ b) >> 1);
#endif
}
/// Two partial sums, of which add_lanes() makes one.
using Sums = std::uint64_t __attribute__((vector_size(16)));
R2M_INLINE Sums absolute_differences(const U8x16& a, const U8x16& b) {
#if defined(__SSE2__)
    return reinterpret_cast<Sums>(_mm_sad_epu8(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
    const U8x16 d = a > b ? a - b : b - a;
    Sums sums{};
    for (int i = 0; i < 16; ++i) sums[i / 8] += d[i];
    return sums;
#endif
}
R2M_INLINE std::uint32_t add_lanes(const Sums& s) {
    return static_cast<std::uint32_t>(s[0] + s[1]);
}

/// Eight samples of a row and eight of the next one.
R2M_INLINE void load_two_rows_of_8(I16x16& v, const u8* from, Stride stride) {
    std::uint64_t rows[2];
    __builtin_memcpy(&rows[0], from, 8);
    __builtin_memcpy(&rows[1], from + stride, 8);
    U8x16 bytes;
    load(bytes, rows);
    v = __builtin_convertvector(bytes, I16x16);
}
/// The lowest 8 bits of each lane.
R2M_INLINE void store_two_rows_of_8(u8* to, Stride stride, const I16x16& v) {
    const U8x16 bytes = __builtin_convertvector(v, U8x16);
    std::uint64_t rows[2];
    store(rows, bytes);
    __builtin_memcpy(to, &rows[0], 8);
    __builtin_memcpy(to + stride, &rows[1], 8);
}
R2M_INLINE I16x8 lower_half(const I16x16& v) {
    return __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7);
}
R2M_INLINE I16x8 upper_half(const I16x16& v) {
    return __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15);
}
R2M_INLINE I32x8 widen(const I16x8& v) {
    return __builtin_convertvector(v, I32x8);
}

R2M_INLINE I16x16 absolute(const I16x16& v) {
    const I16x16 negative = -v;
    return v > negative ? v : negative;
}

R2M_INLINE std::int32_t sum_lanes(const I32x8& v) {
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

R2M_INLINE float sum_lanes(const F32x8& v) {
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

/// Of lanes whose pairwise sums fit 32 bits, whatever the 16-bit values are.
R2M_INLINE std::int32_t sum_lanes(const I16x16& v) {
    return sum_lanes(widen(lower_half(v)) + widen(upper_half(v)));
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
