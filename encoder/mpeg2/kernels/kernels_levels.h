#pragma once

// Quantisation and what becomes of levels; see kernels_body.h.

#include "encoder/mpeg2/kernels/kernels_transforms.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

// Quantisation

Quantised quantise(const float* coefficients, const QuantTable& table, std::int16_t* levels,
                   std::int16_t* dequantised) {
    const I32x8 zero{};
    const F32x8 zero_f{};
    F32x8 distortion{}, energy{};
    I32x8 nonzero{};  // lane v, bit u
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
        nonzero |= (level != zero) & (1 << u);

        const I32x8 negative = c < zero_f;
        store(levels + u * 8, __builtin_convertvector((level ^ negative) - negative, I16x8));
        store(dequantised + u * 8, __builtin_convertvector((value ^ negative) - negative, I16x8));
    }
    std::uint8_t rows[16];
    store_two_rows_of_8(rows, 8, narrow(nonzero, nonzero));
    std::uint64_t mask;
    __builtin_memcpy(&mask, rows, sizeof mask);
    return {mask, sum_lanes(distortion), sum_lanes(energy)};
}

Quantised weigh(const float* coefficients, const std::int16_t* dequantised, const float* weights) {
    F32x8 distortion{}, energy{};
    for (int u = 0; u < 8; ++u) {
        F32x8 c, weight;
        I16x8 value;
        load(c, coefficients + u * 8);
        load(weight, weights + u * 8);
        load(value, dequantised + u * 8);
        const F32x8 error = c - __builtin_convertvector(widen(value), F32x8);
        distortion += error * error * weight;
        energy += c * c * weight;
    }
    return {0, sum_lanes(distortion), sum_lanes(energy)};
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
