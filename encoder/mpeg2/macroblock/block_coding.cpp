#include "encoder/mpeg2/macroblock/block_coding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "encoder/mpeg2/kernels/quantiser.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

std::uint64_t to_scan_order(std::uint64_t raster) {
    std::uint64_t scan = 0;
    for (; raster != 0; raster &= raster - 1)
        scan |= std::uint64_t{1} << scan_of_raster[static_cast<std::size_t>(std::countr_zero(raster))];
    return scan;
}

void quantise(Block& block, const QuantTable& table) {
    const Quantised q = kernels().quantise(block.coefficients, table, block.levels, block.dequantised);
    block.scan_mask = to_scan_order(q.nonzero);
    block.distortion = q.distortion;
    block.energy = q.energy;
    if (!block.weights) return;
    const Quantised weighed = kernels().weigh(block.coefficients, block.dequantised, block.weights->of);
    block.distortion = weighed.distortion;
    block.energy = weighed.energy;
}

/// Bits of dct_dc_size for a difference. [H262, 7.2.1]
int dc_size(int difference) {
    return std::bit_width(static_cast<unsigned>(std::abs(difference)));
}

int magnitude_at(const Block& block, int scan) {
    return std::abs(block.levels[place_of_scan[static_cast<std::size_t>(scan)]]);
}

}  // namespace

CoefficientLengths::CoefficientLengths(const CoefficientCodes& codes) : end_of_block_(codes.end_of_block.length) {
    for (int run = 0; run < 64; ++run)
        for (int level = 0; level < levels; ++level) {
            const bool tabled =
                run < CoefficientCodes::runs && level < CoefficientCodes::levels && codes.code[run][level].length > 0;
            length_[run][level] = static_cast<std::uint8_t>(tabled ? codes.code[run][level].length + 1 : escape_bits);
        }
}

const CoefficientLengths& CoefficientLengths::zero() {
    static const CoefficientLengths lengths(coefficient_codes_zero());
    return lengths;
}
const CoefficientLengths& CoefficientLengths::one() {
    static const CoefficientLengths lengths(coefficient_codes_one());
    return lengths;
}

void quantise_non_intra(Block& block, const QuantTable& table) {
    quantise(block, table);
}

void quantise_intra(Block& block, const QuantTable& table, int dc_bits) {
    const float dc = block.coefficients[0];
    block.coefficients[0] = 0.0f;
    quantise(block, table);
    block.coefficients[0] = dc;
    const int step = 8 >> (dc_bits - 8);
    block.dc = std::clamp(static_cast<int>(std::floor(dc / static_cast<float>(step) + 0.5f)), 0, (1 << dc_bits) - 1);
    block.dequantised[0] = static_cast<std::int16_t>(block.dc * step);
    const float error = dc - static_cast<float>(block.dequantised[0]);
    block.distortion += loss_of(block, 0, error);
}

int coefficient_bits(const Block& block, const CoefficientLengths& lengths, bool intra) {
    int bits = lengths.end_of_block();
    int before = intra ? 0 : -1;
    for (std::uint64_t left = block.scan_mask; left != 0; left &= left - 1) {
        const int scan = std::countr_zero(left);
        bits += lengths.bits_after(before, scan, magnitude_at(block, scan), intra);
        before = scan;
    }
    return bits;
}

int dc_bits(int difference, bool luma) {
    const int size = dc_size(difference);
    return (luma ? luma_dc_size_codes : chroma_dc_size_codes)[static_cast<std::size_t>(size)].length + size;
}

void append_runs(const Block& block, std::vector<RunLevel>& runs, bool intra) {
    int before = intra ? 0 : -1;
    for (std::uint64_t left = block.scan_mask; left != 0; left &= left - 1) {
        const int scan = std::countr_zero(left);
        runs.push_back({static_cast<std::uint8_t>(scan - before - 1),
                        block.levels[place_of_scan[static_cast<std::size_t>(scan)]]});
        before = scan;
    }
}

void write_dc(BitWriter& out, int difference, bool luma) {
    const int size = dc_size(difference);
    out.put((luma ? luma_dc_size_codes : chroma_dc_size_codes)[static_cast<std::size_t>(size)]);
    if (size > 0) out.put(static_cast<std::uint32_t>(difference > 0 ? difference : difference + (1 << size) - 1), size);
}

void write_coefficients(BitWriter& out, const RunLevel* runs, int count, const CoefficientCodes& codes, bool intra) {
    for (int i = 0; i < count; ++i) {
        const auto [run, level] = runs[i];
        const int magnitude = std::abs(level);
        const std::uint32_t sign = level < 0 ? 1 : 0;
        if (!intra && i == 0 && run == 0 && magnitude == 1) {
            out.put(0b10 | sign, 2);
            continue;
        }
        const bool tabled = run < CoefficientCodes::runs && magnitude < CoefficientCodes::levels;
        const Code code = tabled ? codes.code[run][magnitude] : Code{};
        if (code.length > 0) {
            out.put(code.bits << 1 | sign, code.length + 1);
        } else {
            out.put(
                coefficient_escape.bits << 18 | std::uint32_t{run} << 12 | (static_cast<std::uint32_t>(level) & 0xfff),
                escape_bits);
        }
    }
    out.put(codes.end_of_block);
}

}  // namespace render2mpeg::encoder::mpeg2
