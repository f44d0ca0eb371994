#include "encoder/mpeg2/picture_coding.h"

#include <algorithm>

#include "encoder/mpeg2/motion.h"
#include "encoder/mpeg2/row_coding.h"
#include "encoder/mpeg2/syntax.h"
#include "encoder/mpeg2/tuning.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Largest and smallest components, for f_codes.
struct Extent {
    Vector low, high;
    void include(Vector v) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y)};
    }
    void f_codes(int (&f_code)[2]) const {
        f_code[0] = f_code_for(low.x, high.x);
        f_code[1] = f_code_for(low.y, high.y);
    }
};

/// Decides all rows; the rows' own state starts anew in each, so that they can be taken in any order.
std::vector<RowCode> decide(const PictureTask& task, const core::Plane<VectorChoice>& vectors, Frame& reconstruction) {
    PictureCoding picture{task.source,    task.reference,
                          reconstruction, task.reference == nullptr,
                          {1, 1},         task.reference ? lambda_predicted : lambda_intra};
    Extent extent;
    for (const VectorChoice& choice : vectors.values())
        for (int i = 0; i < choice.count; ++i) extent.include(choice.vector[i]);
    extent.f_codes(picture.f_code);
    std::vector<RowCode> rows(static_cast<std::size_t>(task.source.rows()));
    parallel::for_each(rows.size(), [&](std::size_t row) {
        const int r = static_cast<int>(row);
        rows[row] = decide_row(picture, r, task.quantiser, vectors.empty() ? nullptr : vectors.row(r));
    });
    return rows;
}

/// The header that says what the rows turned out to use.
PictureHeader header_for(const PictureTask& task, const std::vector<RowCode>& rows) {
    PictureHeader header;
    header.temporal_reference = task.temporal_reference;
    header.type = task.reference ? PictureType::predicted : PictureType::intra;
    std::int64_t gain = 0;
    Extent extent;
    for (const RowCode& row : rows) {
        gain += row.table_one_gain;
        for (const MacroblockCode& code : row.macroblocks)
            if (code.type.motion_forward) extent.include(code.vector);
    }
    header.intra_vlc_format = gain > 0;
    if (task.reference) extent.f_codes(header.f_code);
    return header;
}

/// Writes all rows as slices and joins them behind the header.
std::vector<std::uint8_t> write(const PictureTask& task, const PictureHeader& header, std::vector<RowCode>& rows) {
    std::vector<std::vector<std::uint8_t>> slices(rows.size());
    parallel::for_each(rows.size(), [&](std::size_t row) {
        BitWriter out;
        const RowSyntax syntax{task.reference == nullptr,
                               task.lines,
                               static_cast<int>(row),
                               task.quantiser,
                               {header.f_code[0], header.f_code[1]},
                               header.intra_vlc_format};
        write_row(out, syntax, rows[row]);
        slices[row] = out.take();
    });
    BitWriter out;
    write_picture_header(out, header);
    std::vector<std::uint8_t> bytes = out.take();
    for (const auto& slice : slices) bytes.insert(bytes.end(), slice.begin(), slice.end());
    return bytes;
}

/// What the outside learns of the rows; vectors of inter macroblocks predict those of the next picture.
void record(const std::vector<RowCode>& rows, PictureResult& result) {
    for (int row = 0; row < result.records.height(); ++row)
        for (int column = 0; column < result.records.width(); ++column) {
            const MacroblockCode& code =
                rows[static_cast<std::size_t>(row)].macroblocks[static_cast<std::size_t>(column)];
            MacroblockRecord& r = result.records.at(column, row);
            r.intra = code.type.intra;
            r.skipped = code.skipped;
            r.quantiser = code.quantiser;
            r.motion_x = code.vector.x;
            r.motion_y = code.vector.y;
            r.bits = code.bits;
            if (!result.vectors.empty()) result.vectors.at(column, row) = code.vector;
        }
}

}  // namespace

PictureResult code_picture(const PictureTask& task, const Level& level) {
    const int columns = task.source.columns(), rows = task.source.rows();
    PictureResult result;
    result.reconstruction = Frame(columns, rows);
    result.records = core::Plane<MacroblockRecord>(columns, rows);
    core::Plane<VectorChoice> vectors;
    if (task.reference) {
        MotionChoice choice =
            choose_vectors({task.source, *task.reference, task.motion, task.previous, level.horizontal_f_code,
                            lambda_motion * static_cast<float>(task.quantiser)});
        vectors = std::move(choice.vectors);
        result.vectors = core::Plane<Vector>(columns, rows);
        result.evaluations = choice.evaluations;
    }
    std::vector<RowCode> decided = decide(task, vectors, result.reconstruction);
    result.bytes = write(task, header_for(task, decided), decided);
    record(decided, result);
    return result;
}

}  // namespace render2mpeg::encoder::mpeg2
