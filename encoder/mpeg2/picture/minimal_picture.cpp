#include "encoder/mpeg2/picture/minimal_picture.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "encoder/mpeg2/bitstream/syntax.h"
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/slice_writing.h"
#include "encoder/mpeg2/macroblock/weighting_matrices.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

constexpr int quantiser = 31;  // of slices in which nothing is quantised

using Color = std::array<std::uint8_t, 3>;  // quantised DCs of Y, Cb, Cr

PictureHeader header_of(PictureType type, int temporal_reference, const ShownFields& shown) {
    PictureHeader header;
    header.temporal_reference = temporal_reference;
    header.type = type;
    header.shown = shown;
    for (int d = 0; d < static_cast<int>(type) - 1; ++d) header.f_code[d][0] = header.f_code[d][1] = 1;
    return header;
}

/// A row of the colour, or of the earlier reference: its ends must be coded, all between them is skipped.
RowCode row_of(PictureType type, int columns, const Color& color) {
    MacroblockCode code;
    code.quantiser = quantiser;
    RowCode row;
    if (type == PictureType::intra) {
        code.type.intra = true;
        code.pattern = 63;
        for (std::size_t i = 0; i < 6; ++i) code.dc[i] = color[i < 4 ? 0 : i - 3];
        row.macroblocks.assign(static_cast<std::size_t>(columns), code);
        return row;
    }
    code.type.motion_forward = true;
    row.macroblocks.assign(static_cast<std::size_t>(columns), code);
    for (int i = 1; i + 1 < columns; ++i) row.macroblocks[static_cast<std::size_t>(i)].skipped = true;
    return row;
}

/// Header and slices; rows differ in nothing but their number. Notes the bits of a row's macroblocks in `row`.
std::vector<std::uint8_t> written(const PictureHeader& header, int lines, int rows, RowCode& row) {
    BitWriter out;
    write_picture_header(out, header);
    for (int r = 0; r < rows; ++r) {
        SliceSyntax syntax{};
        syntax.type = header.type;
        syntax.lines = lines;
        syntax.row = r;
        syntax.quantiser = quantiser;
        std::copy_n(&header.f_code[0][0], 4, &syntax.f_code[0][0]);
        write_slice(out, syntax, row);
    }
    return out.take();
}

Color mean_color(const Frame& frame) {
    Color color;
    for (int i = 0; i < 3; ++i) {
        const auto& values = frame.plane(i).values();
        const std::uint64_t sum = std::accumulate(values.begin(), values.end(), std::uint64_t{0});
        color[static_cast<std::size_t>(i)] =
            static_cast<std::uint8_t>((sum + values.size() / 2) / std::max<std::size_t>(1, values.size()));
    }
    return color;
}

/// Decoded frame of DC-only blocks.
Frame flat_frame(int columns, int rows, const Color& color) {
    Frame frame(columns, rows);
    for (int i = 0; i < 3; ++i) {
        alignas(32) std::int16_t coefficients[64] = {};
        coefficients[0] = static_cast<std::int16_t>(color[static_cast<std::size_t>(i)] * 8);
        control_mismatch(coefficients);
        std::uint8_t block[64];
        kernels().inverse_dct_put(coefficients, block, 8);
        core::Plane<std::uint8_t>& plane = frame.plane(i);
        for (int y = 0; y < plane.height(); ++y)
            for (int x = 0; x < plane.width(); ++x) plane.at(x, y) = block[y % 8 * 8 + x % 8];
    }
    return frame;
}

}  // namespace

PictureResult minimal_picture(const PictureTask& task) {
    const int columns = task.source.columns(), rows = task.source.rows();
    const bool intra = task.type == PictureType::intra;
    const Color color = mean_color(task.source);
    RowCode row = row_of(task.type, columns, color);
    PictureResult result;
    result.bytes = written(header_of(task.type, task.temporal_reference, task.shown), task.lines, rows, row);
    result.reconstruction = intra ? flat_frame(columns, rows, color) : *task.reference[0];
    if (task.type == PictureType::predicted) result.vectors = core::Plane<Vector>(columns, rows);

    result.records = core::Plane<MacroblockRecord>(columns, rows);
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const MacroblockCode& code = row.macroblocks[static_cast<std::size_t>(c)];
            MacroblockRecord& record = result.records.at(c, r);
            record.intra = intra;
            record.forward = !intra;
            record.skipped = code.skipped;
            record.quantiser = quantiser;
            record.bits = code.bits;
        }
    return result;
}

MinimalBits minimal_bits(const Settings& settings, const Level& level) {
    const int columns = (settings.width + 15) / 16, rows = macroblock_rows(settings);
    const auto bits = [&](PictureType type) {
        // A DC of 0 lies farthest from the initial predictor of slices, 128, and has the longest code.
        RowCode row = row_of(type, columns, {0, 0, 0});
        return 8 * static_cast<std::int64_t>(written(header_of(type, 0, {}), settings.height, rows, row).size());
    };
    BitWriter headers;
    write_sequence(headers, settings, level, matrices_for(settings.tune));
    write_gop(headers, settings, settings.first_number, true);
    return {bits(PictureType::intra) + static_cast<std::int64_t>(headers.bit_count()),
            std::max(bits(PictureType::predicted), bits(PictureType::bidirectional))};
}

}  // namespace render2mpeg::encoder::mpeg2
