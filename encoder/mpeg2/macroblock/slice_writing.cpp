#include "encoder/mpeg2/macroblock/slice_writing.h"

#include "encoder/mpeg2/bitstream/codes.h"
#include "encoder/mpeg2/bitstream/syntax.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

void write_address_increment(BitWriter& out, int increment) {
    for (; increment > 33; increment -= 33) out.put(address_increment_codes[0]);
    out.put(address_increment_codes[static_cast<std::size_t>(increment)]);
}

/// Writes one coded macroblock; gives the runs after its own.
const RunLevel* write_macroblock(BitWriter& out, const SliceSyntax& syntax, const SliceState& state,
                                 const MacroblockCode& code, const RunLevel* runs) {
    write_address_increment(out, state.skipped + 1);
    out.put(macroblock_type_code(syntax.type, code.type));
    if (code.type.quant) out.put(code.quantiser, 5);
    for (int d = 0; d < 2; ++d) {
        if (!code.type.motion(d)) continue;
        const Vector v = code.mode.vector[d], before = state.mode.vector[d];
        write_component(out, v.x - before.x, syntax.f_code[d][0]);
        write_component(out, v.y - before.y, syntax.f_code[d][1]);
    }
    if (code.type.pattern) out.put(pattern_codes[code.pattern]);
    const bool one = code.type.intra && syntax.intra_vlc_format;
    const CoefficientCodes& codes = one ? coefficient_codes_one() : coefficient_codes_zero();
    int dc[3] = {state.dc[0], state.dc[1], state.dc[2]};
    for (int i = 0; i < 6; ++i) {
        if ((code.pattern & (32 >> i)) == 0) continue;
        if (code.type.intra) {
            const int plane = i < 4 ? 0 : i - 3;
            write_dc(out, code.dc[i] - dc[plane], plane == 0);
            dc[plane] = code.dc[i];
        }
        write_coefficients(out, runs, code.runs[i], codes, code.type.intra);
        runs += code.runs[i];
    }
    return runs;
}

}  // namespace

void write_slice(BitWriter& out, const SliceSyntax& syntax, RowCode& code) {
    write_slice_header(out, syntax.lines, syntax.row, syntax.quantiser);
    SliceState state(syntax.dc_bits, syntax.quantiser);
    const RunLevel* runs = code.runs.data();
    for (MacroblockCode& macroblock : code.macroblocks) {
        const std::size_t before = out.bit_count();
        if (!macroblock.skipped) runs = write_macroblock(out, syntax, state, macroblock, runs);
        macroblock.bits = static_cast<std::uint32_t>(out.bit_count() - before);
        advance(state, macroblock);
    }
    out.align();
}

}  // namespace render2mpeg::encoder::mpeg2
