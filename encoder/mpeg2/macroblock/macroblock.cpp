#include "encoder/mpeg2/macroblock/macroblock.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/macroblock/trellis.h"

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

/// Lowers the levels of a quantised block where that is worth it; gives its coefficients' bits with table B-14.
int rdoq(Block& block, const QuantTable& table, bool intra, float lambda) {
    const CoefficientLengths& lengths = CoefficientLengths::zero();
    trellis_rdoq(block, table, lengths, intra, lambda);
    return coefficient_bits(block, lengths, intra);
}

/// Null: all 1, as for chroma.
const Weights* weights_of(const PictureCoding& picture, const Place& p) {
    return p.plane == 0 ? picture.weights : nullptr;
}

float weighted_difference(const std::uint8_t* source, std::ptrdiff_t stride, const std::uint8_t* predicted,
                          std::ptrdiff_t predicted_stride, const Weights& weights) {
    static constexpr std::int16_t nothing[64] = {};
    alignas(32) float coefficients[64];
    kernels().forward_dct_of_difference(coefficients, source, stride, predicted, predicted_stride);
    return kernels().weigh(coefficients, nothing, weights.of).energy;
}

/// Codes block i of the difference from the prediction. Leaves scan_mask 0 where nothing is worth coding.
void code_difference(const PictureCoding& picture, int column, int row, int i, const QuantTable& table, float lambda,
                     ModeTrial& out) {
    const Kernels& k = kernels();
    const Place& p = places[i];
    Block& block = out.block[i];
    const std::uint8_t* source = samples_at(picture.source, column, row, p);
    const std::uint8_t* predicted = predicted_at(out.prediction, p);
    const std::ptrdiff_t stride = stride_of(picture.source, p.plane);

    block.weights = weights_of(picture, p);

    // No coefficient's square exceeds the sum of all, which is that of the samples: below the step all vanish.
    const auto energy = static_cast<float>(k.ssd_8x8(source, stride, predicted, prediction_stride(p)));
    const float least = picture.effort == Effort::fast ? energy_fast : 1.0f;
    if (energy * table.largest_reciprocal * table.largest_reciprocal < least) {
        block.scan_mask = 0;
        block.energy = block.distortion =
            block.weights ? weighted_difference(source, stride, predicted, prediction_stride(p), *block.weights)
                          : energy;
        return;
    }
    k.forward_dct_of_difference(block.coefficients, source, stride, predicted, prediction_stride(p));
    quantise_non_intra(block, table);
    if (block.scan_mask == 0) return;
    block.bits = rdoq(block, table, false, lambda);
    if (block.energy <= block.distortion + lambda * static_cast<float>(block.bits)) block.scan_mask = 0;
}

/// Rate and distortion of an inter trial with settled blocks.
RdCost rd_cost_inter(const PictureCoding& picture, const SliceState& state, const ModeTrial& trial) {
    RdCost t;
    int coefficients = 0;
    for (int i = 0; i < 6; ++i) {
        const Block& block = trial.block[i];
        const bool coded = block.scan_mask != 0;
        t.distortion += coded ? block.distortion : block.energy;
        if (!coded) continue;
        t.pattern |= 32 >> i;
        coefficients += block.bits;
    }
    // A zero vector goes without saying where there are coefficients in a P picture.
    const bool coded = t.pattern != 0;
    const bool implicit_zero = picture.type == PictureType::predicted && coded && trial.mode.vector[0].is_zero();
    t.type = {false, trial.mode.uses[0] && !implicit_zero, coded, coded && trial.quantiser != state.quantiser,
              trial.mode.uses[1]};
    t.bits = macroblock_type_code(picture.type, t.type).length + coefficients;
    if (t.type.quant) t.bits += quantiser_bits;
    if (coded) t.bits += pattern_codes[static_cast<std::size_t>(t.pattern)].length;
    if (!implicit_zero) t.bits += vector_bits(picture, state, trial.mode);
    t.bits_with_one = t.bits;
    return t;
}

RdCost rd_cost_intra(const PictureCoding& picture, const SliceState& state, const ModeTrial& trial) {
    RdCost t;
    t.type = {true, false, false, trial.quantiser != state.quantiser};
    t.pattern = 63;
    int common = macroblock_type_code(picture.type, t.type).length + (t.type.quant ? quantiser_bits : 0);
    int dc[3] = {state.dc[0], state.dc[1], state.dc[2]};
    for (int i = 0; i < 6; ++i) {
        const Block& block = trial.block[i];
        const int plane = places[i].plane;
        t.distortion += block.distortion;
        common += dc_bits(block.dc - dc[plane], plane == 0);
        dc[plane] = block.dc;
        t.bits += block.bits;
        t.bits_with_one += coefficient_bits(block, CoefficientLengths::one(), true);
    }
    t.bits += common;
    t.bits_with_one += common;
    return t;
}

}  // namespace

void try_inter(const PictureCoding& picture, int column, int row, const PredictionMode& mode, int quantiser,
               const SliceState& state, ModeTrial& out, bool luma_is_predicted) {
    const QuantTable& table = picture.quantisers->of(quantiser).non_intra;
    const float lambda = lambda_of(picture, quantiser);
    out.mode = mode;
    out.quantiser = quantiser;
    if (!luma_is_predicted) predict_luma(picture, column, row, mode, out.prediction);
    predict_chroma(picture, column, row, mode, out.prediction);
    for (int i = 0; i < 6; ++i) code_difference(picture, column, row, i, table, lambda, out);
    out.rd = rd_cost_inter(picture, state, out);
    if (out.rd.pattern == 0) return;

    // Try without any coefficient: the pattern's bits are saved too.
    std::uint64_t masks[6];
    for (int i = 0; i < 6; ++i) masks[i] = std::exchange(out.block[i].scan_mask, 0);
    const RdCost empty = rd_cost_inter(picture, state, out);
    if (empty.cost(lambda) <= out.rd.cost(lambda)) {
        out.rd = empty;
        return;
    }
    for (int i = 0; i < 6; ++i) out.block[i].scan_mask = masks[i];
}

void try_intra(const PictureCoding& picture, int column, int row, int quantiser, const SliceState& state,
               ModeTrial& out) {
    const Kernels& k = kernels();
    const QuantTable& table = picture.quantisers->of(quantiser).intra;
    const float lambda = lambda_of(picture, quantiser);
    out.mode = {{}, {false, false}};
    out.quantiser = quantiser;
    for (int i = 0; i < 6; ++i) {
        Block& block = out.block[i];
        k.forward_dct(block.coefficients, samples_at(picture.source, column, row, places[i]),
                      stride_of(picture.source, places[i].plane));
        block.weights = weights_of(picture, places[i]);
        quantise_intra(block, table, picture.dc_bits);
        block.bits = rdoq(block, table, true, lambda);
    }
    out.rd = rd_cost_intra(picture, state, out);
}

void predict_luma(const PictureCoding& picture, int column, int row, const PredictionMode& mode, Prediction& out) {
    const int first = mode.uses[0] ? 0 : 1;
    predict_luma(*picture.reference[first], column, row, mode.vector[first], out.y);
    if (first == 1 || !mode.uses[1]) return;
    alignas(32) std::uint8_t later[256];
    predict_luma(*picture.reference[1], column, row, mode.vector[1], later);
    kernels().average(out.y, later, 256);
}

void predict_chroma(const PictureCoding& picture, int column, int row, const PredictionMode& mode, Prediction& out) {
    const int first = mode.uses[0] ? 0 : 1;
    predict_chroma(*picture.reference[first], column, row, mode.vector[first], out);
    if (first == 1 || !mode.uses[1]) return;
    Prediction later;
    predict_chroma(*picture.reference[1], column, row, mode.vector[1], later);
    kernels().average(out.cb, later.cb, 64);
    kernels().average(out.cr, later.cr, 64);
}

const PredictionMode* skip_mode(const PictureCoding& picture, int column, int row, const SliceState& state) {
    static constexpr PredictionMode zero{};
    if (picture.type == PictureType::predicted) return &zero;
    const PredictionMode& before = state.mode;
    if (picture.type == PictureType::intra || (!before.uses[0] && !before.uses[1])) return nullptr;
    for (int d = 0; d < 2; ++d) {
        const VectorRange range = vector_range(column, row, picture.source.columns(), picture.source.rows(),
                                               picture.f_code[d][0], picture.f_code[d][1]);
        if (before.uses[d] && !range.contains(before.vector[d])) return nullptr;
    }
    return &before;
}

int vector_bits(const PictureCoding& picture, const SliceState& state, const PredictionMode& mode) {
    int bits = 0;
    for (int d = 0; d < 2; ++d) {
        if (!mode.uses[d]) continue;
        const Vector v = mode.vector[d], before = state.mode.vector[d];
        bits +=
            component_bits(v.x - before.x, picture.f_code[d][0]) + component_bits(v.y - before.y, picture.f_code[d][1]);
    }
    return bits;
}

float cost_to_go(const PictureCoding& picture, const SliceState& state, const PredictionMode& mode,
                 const CostToGo* const (&to_go)[2]) {
    const bool intra = !mode.uses[0] && !mode.uses[1];
    float bits = 0.0f;
    for (int d = 0; d < 2; ++d) {
        if (!picture.bits[d] || !to_go[d]) continue;
        const Vector left = mode.uses[d] ? mode.vector[d] : intra ? Vector{} : state.mode.vector[d];
        bits += (*to_go[d])(left, *picture.bits[d]);
    }
    return picture.type == PictureType::bidirectional ? cost_to_go_bidirectional * bits : bits;
}

float luma_distortion(const PictureCoding& picture, int column, int row, const Prediction& prediction) {
    const std::ptrdiff_t stride = stride_of(picture.source, 0);
    if (!picture.weights)
        return static_cast<float>(
            kernels().ssd_16x16(samples_at(picture.source, column, row, places[0]), stride, prediction.y, 16));
    float sum = 0.0f;
    for (int i = 0; i < 4; ++i)
        sum += weighted_difference(samples_at(picture.source, column, row, places[i]), stride,
                                   predicted_at(prediction, places[i]), 16, *picture.weights);
    return sum;
}

float chroma_distortion(const PictureCoding& picture, int column, int row, const Prediction& prediction) {
    std::uint32_t sum = 0;
    for (const Place& p : {places[4], places[5]})
        sum += kernels().ssd_8x8(samples_at(picture.source, column, row, p), stride_of(picture.source, p.plane),
                                 predicted_at(prediction, p), prediction_stride(p));
    return static_cast<float>(sum);
}

void truncate_to(ModeTrial& trial, const PictureCoding& picture, const SliceState& state, int limit) {
    for (int keep = 63; keep >= 0 && std::max(trial.rd.bits, trial.rd.bits_with_one) > limit; --keep) {
        for (Block& block : trial.block) {
            if ((block.scan_mask >> keep & 1) == 0) continue;
            const std::size_t place = place_of_scan[static_cast<std::size_t>(keep)];
            const float error = block.coefficients[place] - static_cast<float>(block.dequantised[place]);
            block.distortion += loss_of(block, place, block.coefficients[place]) - loss_of(block, place, error);
            block.levels[place] = block.dequantised[place] = 0;
            block.scan_mask ^= std::uint64_t{1} << keep;
            block.bits = coefficient_bits(block, CoefficientLengths::zero(), trial.rd.type.intra);
        }
        trial.rd = trial.rd.type.intra ? rd_cost_intra(picture, state, trial) : rd_cost_inter(picture, state, trial);
    }
}

void reconstruct(const PictureCoding& picture, int column, int row, ModeTrial& trial) {
    const Kernels& k = kernels();
    for (int i = 0; i < 6; ++i) {
        const Place& p = places[i];
        Block& block = trial.block[i];
        std::uint8_t* out = samples_at(picture.reconstruction, column, row, p);
        const std::ptrdiff_t stride = stride_of(picture.reconstruction, p.plane);
        if (trial.rd.type.intra) {
            control_mismatch(block.dequantised);
            k.inverse_dct_put(block.dequantised, out, stride);
            continue;
        }
        const std::uint8_t* predicted = predicted_at(trial.prediction, p);
        for (int y = 0; y < 8; ++y) std::memcpy(out + y * stride, predicted + y * prediction_stride(p), 8);
        if (block.scan_mask == 0) continue;
        control_mismatch(block.dequantised);
        k.inverse_dct_add(block.dequantised, out, stride);
    }
}

void reconstruct_skipped(const PictureCoding& picture, int column, int row, const Prediction& prediction) {
    for (const Place& p : {places[0], places[4], places[5]}) {
        const int size = p.plane == 0 ? 16 : 8;
        std::uint8_t* out = samples_at(picture.reconstruction, column, row, p);
        for (int y = 0; y < size; ++y)
            std::memcpy(out + y * stride_of(picture.reconstruction, p.plane),
                        predicted_at(prediction, p) + y * prediction_stride(p), static_cast<std::size_t>(size));
    }
}

void advance(SliceState& state, const MacroblockCode& code) {
    state.skipped = code.skipped ? state.skipped + 1 : 0;
    if (!code.skipped && code.type.quant) state.quantiser = code.quantiser;
    if (code.type.intra) {
        state.dc[0] = code.dc[3];
        state.dc[1] = code.dc[4];
        state.dc[2] = code.dc[5];
        state.mode = {{}, {false, false}};
        return;
    }
    // A vector that is not sent stays as prediction; one that is zero without saying (P pictures) resets it.
    state.reset_dc();
    for (int d = 0; d < 2; ++d) {
        state.mode.uses[d] = code.mode.uses[d];
        if (code.mode.uses[d]) state.mode.vector[d] = code.mode.vector[d];
    }
}

int address_increment_bits(int skipped) {
    const int increment = skipped + 1, escapes = (increment - 1) / 33;
    return escapes * address_increment_codes[0].length +
           address_increment_codes[static_cast<std::size_t>(increment - escapes * 33)].length;
}

}  // namespace render2mpeg::encoder::mpeg2
