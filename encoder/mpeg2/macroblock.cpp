#include "encoder/mpeg2/macroblock.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Where a block lies: its plane and its upper left sample within the macroblock's part of that plane.
struct Place {
    int plane, x, y;
};
constexpr int quantiser_bits = 5;  // quantiser_scale_code
constexpr Place places[6] = {{0, 0, 0}, {0, 8, 0}, {0, 0, 8}, {0, 8, 8}, {1, 0, 0}, {2, 0, 0}};

std::ptrdiff_t stride_of(const Frame& frame, int plane) {
    return frame.plane(plane).width();
}

template <class F>
auto* samples_at(F& frame, int column, int row, const Place& p) {
    const int size = p.plane == 0 ? 16 : 8;
    return frame.plane(p.plane).row(row * size + p.y) + column * size + p.x;
}

const std::uint8_t* predicted_at(const Prediction& prediction, const Place& p) {
    return p.plane == 0 ? prediction.y + p.y * 16 + p.x : p.plane == 1 ? prediction.cb : prediction.cr;
}
std::ptrdiff_t prediction_stride(const Place& p) {
    return p.plane == 0 ? 16 : 8;
}

float lambda_of(const PictureCoding& picture, int quantiser) {
    return picture.lambda_factor * static_cast<float>(quantiser * quantiser);
}

/// Codes block i of the difference from the prediction. Leaves scan_mask 0 where nothing is worth coding.
void code_difference(const PictureCoding& picture, int column, int row, int i, const QuantTable& table, float lambda,
                     Attempt& out) {
    const Kernels& k = kernels();
    const Place& p = places[i];
    Block& block = out.block[i];
    const std::uint8_t* source = samples_at(picture.source, column, row, p);
    const std::uint8_t* predicted = predicted_at(out.prediction, p);
    const std::ptrdiff_t stride = stride_of(picture.source, p.plane);

    // No basis function exceeds 1/4, hence no coefficient a quarter of the sum of absolute differences: below the step
    // all vanish.
    const float largest = 0.25f * static_cast<float>(k.sad_8x8(source, stride, predicted, prediction_stride(p)));
    if (largest * table.reciprocal[63] < 1.0f) {
        block.scan_mask = 0;
        block.energy = block.distortion =
            static_cast<float>(k.ssd_8x8(source, stride, predicted, prediction_stride(p)));
        return;
    }
    k.forward_dct_of_difference(block.coefficients, source, stride, predicted, prediction_stride(p));
    quantise_non_intra(block, table);
    if (block.scan_mask == 0) return;
    economise(block, table, CoefficientLengths::zero(), false, lambda);
    const int bits = coefficient_bits(block, CoefficientLengths::zero(), false);
    if (block.energy <= block.distortion + lambda * static_cast<float>(bits)) block.scan_mask = 0;
}

/// What an inter attempt comes to whose blocks are settled.
Totals total_inter(const PictureCoding& picture, const SliceState& state, const Attempt& attempt) {
    Totals t;
    int coefficients = 0;
    for (int i = 0; i < 6; ++i) {
        const Block& block = attempt.block[i];
        const bool coded = block.scan_mask != 0;
        t.distortion += coded ? block.distortion : block.energy;
        if (!coded) continue;
        t.pattern |= 32 >> i;
        coefficients += coefficient_bits(block, CoefficientLengths::zero(), false);
    }
    // A zero vector goes without saying where there are coefficients.
    const bool coded = t.pattern != 0;
    t.type = {false, !coded || !attempt.vector.is_zero(), coded, coded && attempt.quantiser != state.quantiser};
    t.bits = macroblock_type_code(picture.intra_picture, t.type).length + coefficients;
    if (t.type.quant) t.bits += quantiser_bits;
    if (coded) t.bits += pattern_codes[static_cast<std::size_t>(t.pattern)].length;
    if (t.type.motion_forward)
        t.bits += component_bits(attempt.vector.x - state.vector.x, picture.f_code[0]) +
                  component_bits(attempt.vector.y - state.vector.y, picture.f_code[1]);
    t.bits_with_one = t.bits;
    return t;
}

Totals total_intra(const PictureCoding& picture, const SliceState& state, const Attempt& attempt) {
    Totals t;
    t.type = {true, false, false, attempt.quantiser != state.quantiser};
    t.pattern = 63;
    int common = macroblock_type_code(picture.intra_picture, t.type).length + (t.type.quant ? quantiser_bits : 0);
    int dc[3] = {state.dc[0], state.dc[1], state.dc[2]};
    for (int i = 0; i < 6; ++i) {
        const Block& block = attempt.block[i];
        const int plane = places[i].plane;
        t.distortion += block.distortion;
        common += dc_bits(block.dc - dc[plane], plane == 0);
        dc[plane] = block.dc;
        t.bits += coefficient_bits(block, CoefficientLengths::zero(), true);
        t.bits_with_one += coefficient_bits(block, CoefficientLengths::one(), true);
    }
    t.bits += common;
    t.bits_with_one += common;
    return t;
}

}  // namespace

void attempt_inter(const PictureCoding& picture, int column, int row, Vector v, int quantiser, const SliceState& state,
                   Attempt& out) {
    const QuantTable& table = Quantiser::of(quantiser).non_intra;
    const float lambda = lambda_of(picture, quantiser);
    out.vector = v;
    out.quantiser = quantiser;
    predict(*picture.reference, column, row, v, out.prediction);
    for (int i = 0; i < 6; ++i) code_difference(picture, column, row, i, table, lambda, out);
    out.totals = total_inter(picture, state, out);
    if (out.totals.pattern == 0) return;

    // Try without any coefficient: the pattern's bits are saved too.
    std::uint64_t masks[6];
    for (int i = 0; i < 6; ++i) masks[i] = std::exchange(out.block[i].scan_mask, 0);
    const Totals empty = total_inter(picture, state, out);
    if (empty.cost(lambda) <= out.totals.cost(lambda)) {
        out.totals = empty;
        return;
    }
    for (int i = 0; i < 6; ++i) out.block[i].scan_mask = masks[i];
}

void attempt_intra(const PictureCoding& picture, int column, int row, int quantiser, const SliceState& state,
                   Attempt& out) {
    const Kernels& k = kernels();
    const QuantTable& table = Quantiser::of(quantiser).intra;
    const float lambda = lambda_of(picture, quantiser);
    out.vector = {};
    out.quantiser = quantiser;
    for (int i = 0; i < 6; ++i) {
        Block& block = out.block[i];
        k.forward_dct(block.coefficients, samples_at(picture.source, column, row, places[i]),
                      stride_of(picture.source, places[i].plane));
        quantise_intra(block, table);
        economise(block, table, CoefficientLengths::zero(), true, lambda);
    }
    out.totals = total_intra(picture, state, out);
}

float skip_distortion(const PictureCoding& picture, int column, int row) {
    const Kernels& k = kernels();
    float sum = 0.0f;
    for (const Place& p : {places[0], places[4], places[5]}) {
        const std::ptrdiff_t stride = stride_of(picture.source, p.plane);
        const auto ssd = p.plane == 0 ? k.ssd_16x16 : k.ssd_8x8;
        sum += static_cast<float>(ssd(samples_at(picture.source, column, row, p), stride,
                                      samples_at(*picture.reference, column, row, p), stride));
    }
    return sum;
}

void truncate_to(Attempt& attempt, const PictureCoding& picture, const SliceState& state, int limit) {
    for (int keep = 63; keep >= 0 && std::max(attempt.totals.bits, attempt.totals.bits_with_one) > limit; --keep) {
        for (Block& block : attempt.block) {
            if ((block.scan_mask >> keep & 1) == 0) continue;
            const std::size_t place = place_of_scan[static_cast<std::size_t>(keep)];
            const float error = block.coefficients[place] - static_cast<float>(block.dequantised[place]);
            block.distortion += block.coefficients[place] * block.coefficients[place] - error * error;
            block.levels[place] = block.dequantised[place] = 0;
            block.scan_mask ^= std::uint64_t{1} << keep;
        }
        attempt.totals =
            attempt.totals.type.intra ? total_intra(picture, state, attempt) : total_inter(picture, state, attempt);
    }
}

void reconstruct(const PictureCoding& picture, int column, int row, Attempt& attempt) {
    const Kernels& k = kernels();
    for (int i = 0; i < 6; ++i) {
        const Place& p = places[i];
        Block& block = attempt.block[i];
        std::uint8_t* out = samples_at(picture.reconstruction, column, row, p);
        const std::ptrdiff_t stride = stride_of(picture.reconstruction, p.plane);
        if (attempt.totals.type.intra) {
            control_mismatch(block.dequantised);
            k.inverse_dct_put(block.dequantised, out, stride);
            continue;
        }
        const std::uint8_t* predicted = predicted_at(attempt.prediction, p);
        for (int y = 0; y < 8; ++y) std::memcpy(out + y * stride, predicted + y * prediction_stride(p), 8);
        if (block.scan_mask == 0) continue;
        control_mismatch(block.dequantised);
        k.inverse_dct_add(block.dequantised, out, stride);
    }
}

void reconstruct_skipped(const PictureCoding& picture, int column, int row) {
    for (int plane = 0; plane < 3; ++plane) {
        const int size = plane == 0 ? 16 : 8;
        for (int y = row * size; y < (row + 1) * size; ++y)
            std::memcpy(picture.reconstruction.plane(plane).row(y) + column * size,
                        picture.reference->plane(plane).row(y) + column * size, static_cast<std::size_t>(size));
    }
}

void advance(SliceState& state, const MacroblockCode& code) {
    if (code.skipped) {
        ++state.skipped;
        state.reset_dc();
        state.vector = {};
        return;
    }
    state.skipped = 0;
    if (code.type.quant) state.quantiser = code.quantiser;
    if (code.type.intra) {
        state.dc[0] = code.dc[3];
        state.dc[1] = code.dc[4];
        state.dc[2] = code.dc[5];
        state.vector = {};
        return;
    }
    state.reset_dc();
    state.vector = code.type.motion_forward ? code.vector : Vector{};
}

int address_increment_bits(int skipped) {
    const int increment = skipped + 1, escapes = (increment - 1) / 33;
    return escapes * address_increment_codes[0].length +
           address_increment_codes[static_cast<std::size_t>(increment - escapes * 33)].length;
}

}  // namespace render2mpeg::encoder::mpeg2
