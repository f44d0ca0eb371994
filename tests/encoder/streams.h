#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "encoder/mpeg2/bitstream/syntax.h"
#include "encoder/mpeg2/kernels/kernels.h"
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/slice_writing.h"
#include "encoder/mpeg2/macroblock/weighting_matrices.h"
#include "film.h"

/// Pictures written macroblock by macroblock as a test wants them, without the encoder's choices.
namespace render2mpeg::encoder::mpeg2::testing {

using encoder::testing::Libavcodec;
using encoder::testing::settings;

inline constexpr int columns = 45, rows = 36;  // Main level's largest picture
inline constexpr int quantiser = 1;

/// Access units with rows written as given.
inline std::vector<std::uint8_t> access_unit(const PictureHeader& header, std::vector<RowCode>& code, bool first) {
    const Settings s = settings(columns * 16, rows * 16);
    BitWriter out;
    if (first) {
        write_sequence(out, s, level_for(s), matrices_for(s.tune));
        write_gop(out, s, 0, true);
    }
    write_picture_header(out, header);
    for (int row = 0; row < rows; ++row) {
        SliceSyntax syntax{header.type, s.height, row, quantiser, {}, header.intra_vlc_format};
        std::copy_n(&header.f_code[0][0], 4, &syntax.f_code[0][0]);
        write_slice(out, syntax, code[static_cast<std::size_t>(row)]);
    }
    return out.take();
}

inline MacroblockCode plain_intra(int dc = 128) {
    MacroblockCode m;
    m.type.intra = true;
    m.pattern = 63;
    m.quantiser = quantiser;
    std::fill_n(m.dc, 6, static_cast<std::uint16_t>(dc));
    return m;
}

inline std::vector<RowCode> plain_rows(const MacroblockCode& each) {
    std::vector<RowCode> code(rows);
    for (RowCode& row : code) row.macroblocks.assign(columns, each);
    return code;
}

/// What one block shows: intra from its DC, non-intra on top of grey.
inline std::array<std::uint8_t, 64> shown(bool intra, int dc, const std::vector<RunLevel>& runs, int q = quantiser) {
    const QuantTable& table = intra ? Quantiser::of(q).intra : Quantiser::of(q).non_intra;
    std::int16_t c[64] = {};
    int scan = intra ? 0 : -1;
    for (const auto& [run, level] : runs) {
        scan += run + 1;
        const std::size_t place = place_of_scan[static_cast<std::size_t>(scan)];
        const int value = ((2 * std::abs(level) + table.reconstruction) * table.weight[place]) >> 4;
        c[place] = static_cast<std::int16_t>(level < 0 ? -value : value);
    }
    if (intra) c[0] = static_cast<std::int16_t>(dc * 8);
    std::array<std::uint8_t, 64> out;
    out.fill(128);
    if (intra || !runs.empty()) control_mismatch(c);
    if (intra) {
        kernels().inverse_dct_put(c, out.data(), 8);
    } else if (!runs.empty()) {
        kernels().inverse_dct_add(c, out.data(), 8);
    }
    return out;
}

}  // namespace render2mpeg::encoder::mpeg2::testing
