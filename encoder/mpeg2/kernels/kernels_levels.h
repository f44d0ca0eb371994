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

// Levels that are not worth their bits

R2M_INLINE std::uint64_t reversed(std::uint64_t bits) {
    const auto swap = [&](int by, std::uint64_t mask) { bits = (bits >> by & mask) | (bits & mask) << by; };
    swap(1, 0x5555555555555555u);
    swap(2, 0x3333333333333333u);
    swap(4, 0x0f0f0f0f0f0f0f0fu);
    return __builtin_bswap64(bits);
}

R2M_INLINE int with_sign(int magnitude, int sign) {
    return (magnitude ^ sign) - sign;
}

/// A level, and what it would lose by falling by one.
struct Fall {
    int place;      ///< of the coefficient
    int sign;       ///< -1 or 0
    int magnitude;  ///< of the level
    int lower;      ///< dequantised magnitude of the level below
    float loss;     ///< distortion there less distortion here
};
R2M_INLINE Fall fall_of(const QuantisedBlock& block, const QuantTable& table, int place) {
    const int level = block.levels[place], sign = level >> 31, magnitude = with_sign(level, sign);
    const int value = with_sign(block.dequantised[place], sign);
    const int lower = dequantised_magnitude(table, place, magnitude - 1);
    // (c - lower)^2 - (c - value)^2
    const float c = block.coefficients[place];
    float loss = static_cast<float>(value - lower) * (2 * (c < 0 ? -c : c) - static_cast<float>(value + lower));
    if (block.weights) loss *= block.weights[place];
    return {place, sign, magnitude, lower, loss};
}

R2M_INLINE int tabled(int magnitude) {
    return magnitude < 63 ? magnitude : 63;
}

int greedy_rdoq(QuantisedBlock& block, const QuantTable& table, const CodeLengthTables& tables, bool intra,
                float lambda) {
    if (block.scan_mask == 0) return tables.end_of_block;
    const int start = intra ? 0 : -1;  // past DC in intra blocks: a run counts from the coefficient before
    const auto row = [&](int before, int scan) {
        return !intra && scan == 0 ? tables.first : tables.length + (scan - before - 1) * 64;
    };
    int after = -1, after_magnitude = 0;  // the next coefficient still there
    int bits = tables.end_of_block;
    std::uint64_t kept = block.scan_mask;
    float lost = 0.0f;

    // From the last one to the first: trailing zeros are counted faster than leading ones.
    std::uint64_t left = reversed(kept);
    int scan = 63 - __builtin_ctzll(left);
    for (bool more = true; more;) {
        left &= left - 1;
        more = left != 0;
        const int before = more ? 63 - __builtin_ctzll(left) : start;
        const Fall fall = fall_of(block, table, tables.place_of_scan[scan]);

        // Price the level and the one below.
        const std::uint8_t* own = row(before, scan);
        const int next = after >= 0 ? row(scan, after)[after_magnitude] : 0;
        int stays = tabled(fall.magnitude), saved = own[stays];
        if (fall.magnitude > 1)
            saved -= own[stays - 1];
        else if (after >= 0)
            saved += next - row(before, after)[after_magnitude];

        if (fall.loss < lambda * static_cast<float>(saved)) {
            lost += fall.loss;
            block.levels[fall.place] = static_cast<std::int16_t>(with_sign(fall.magnitude - 1, fall.sign));
            block.dequantised[fall.place] = static_cast<std::int16_t>(with_sign(fall.lower, fall.sign));
            stays = tabled(fall.magnitude - 1);
            if (stays == 0) kept &= ~(std::uint64_t{1} << scan);
        }
        if (stays > 0) {
            bits += next;
            after = scan;
            after_magnitude = stays;
        }
        scan = before;
    }
    block.distortion += lost;
    block.scan_mask = kept;
    return after >= 0 ? bits + row(start, after)[after_magnitude] : bits;
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
