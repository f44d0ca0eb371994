#include "encoder/mpeg2/picture/picture_coding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

#include "encoder/mpeg2/bitstream/syntax.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/macroblock/mode_decision.h"
#include "encoder/mpeg2/macroblock/slice_writing.h"
#include "encoder/mpeg2/motion/motion_estimation.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

void set_f_codes(int (&f_code)[2], const VectorExtent& extent) {
    f_code[0] = f_code_for(extent.low.x, extent.high.x);
    f_code[1] = f_code_for(extent.low.y, extent.high.y);
}

float lambda_factor(PictureType type) {
    return type == PictureType::intra       ? lambda_intra
           : type == PictureType::predicted ? lambda_predicted
                                            : lambda_bidirectional;
}

/// Vectors of each direction to decide among; empty where the picture has no reference.
using Vectors = std::array<core::Plane<BestVectors>, 2>;

std::optional<MotionSources> sources_of(const PictureTask& task, const Level& level, std::size_t d) {
    if (!task.reference[d]) return std::nullopt;
    const bool bidirectional = task.type == PictureType::bidirectional, fast = task.effort == Effort::fast;
    const auto q = static_cast<float>(task.quantiser);
    return MotionSources{task.source,
                         *task.reference[d],
                         task.exact[d],
                         task.predictors[d],
                         level.horizontal_f_code,
                         lambda_motion * q,
                         !bidirectional,
                         fast ? static_cast<std::uint32_t>(enough_fast * task.quantiser) : 0,
                         bidirectional ? evaluation_limit_per_direction : evaluation_limit_of_vectors,
                         fast ? search_reach_fast : search_reach,
                         static_cast<std::uint32_t>(good_enough * task.quantiser)};
}

Vectors choose(const PictureTask& task, const Level& level, MotionWork& work) {
    Vectors vectors;
    for (std::size_t d = 0; d < 2; ++d) {
        const std::optional<MotionSources> sources = sources_of(task, level, d);
        if (!sources) continue;
        MotionEstimate choice = estimate_motion(*sources);
        vectors[d] = std::move(choice.vectors);
        work += choice.work;
    }
    return vectors;
}

/// quantiser_scale_code of every macroblock.
core::Plane<std::uint8_t> quantisers_of(const PictureTask& task) {
    core::Plane<std::uint8_t> codes(task.source.columns(), task.source.rows(),
                                    static_cast<std::uint8_t>(task.quantiser));
    if (!task.quantiser_factors) return codes;
    EXPECTS(task.quantiser_factors->size() == codes.size());
    std::transform(task.quantiser_factors->values().begin(), task.quantiser_factors->values().end(),
                   codes.values().begin(), [&](float factor) {
                       const long code = std::lround(static_cast<float>(task.quantiser) * factor);
                       return static_cast<std::uint8_t>(std::clamp(code, 1l, 31l));
                   });
    return codes;
}

/// Decides all rows; the rows' own state starts anew in each, so that they can be taken in any order.
std::vector<RowCode> decide(const PictureTask& task, const Vectors& vectors, const FastMotionSearch* fast_search,
                            Frame& reconstruction) {
    PictureCoding picture{task.source,
                          {task.reference[0], task.reference[1]},
                          reconstruction,
                          task.type,
                          {{1, 1}, {1, 1}},
                          task.bit_weight * lambda_factor(task.type),
                          task.effort,
                          task.quantisers,
                          dc_bits_for(task.quantiser),
                          task.weights,
                          task.intra_due,
                          task.forced,
                          fast_search};
    for (std::size_t d = 0; d < 2; ++d) {
        if (fast_search) {
            std::copy_n(fast_search->f_code(static_cast<int>(d)), 2, picture.f_code[d]);
            continue;
        }
        VectorExtent extent;
        for (const BestVectors& choice : vectors[d].values())
            for (int i = 0; i < choice.count; ++i) extent.include(choice.vector[i]);
        set_f_codes(picture.f_code[d], extent);
    }
    const VectorBits bits[2] = {{picture.f_code[0][0], picture.f_code[0][1], task.type == PictureType::predicted},
                                {picture.f_code[1][0], picture.f_code[1][1], false}};
    for (std::size_t d = 0; d < 2; ++d)
        if (!vectors[d].empty()) picture.bits[d] = &bits[d];
    const core::Plane<std::uint8_t> quantisers = quantisers_of(task);
    std::vector<RowCode> rows(static_cast<std::size_t>(task.source.rows()));
    parallel::for_each(rows.size(), [&](std::size_t row) {
        const int r = static_cast<int>(row);
        const BestVectors* const choices[2] = {vectors[0].empty() ? nullptr : vectors[0].row(r),
                                               vectors[1].empty() ? nullptr : vectors[1].row(r)};
        rows[row] = decide_row(picture, r, quantisers.row(r), choices);
    });
    return rows;
}

/// The header with the parameters actually used by the rows.
PictureHeader header_for(const PictureTask& task, const std::vector<RowCode>& rows) {
    PictureHeader header;
    header.temporal_reference = task.temporal_reference;
    header.type = task.type;
    header.intra_dc_bits = dc_bits_for(task.quantiser);
    header.shown = task.shown;
    std::int64_t gain = 0;
    VectorExtent extent[2];
    for (const RowCode& row : rows) {
        gain += row.table_one_gain;
        for (const MacroblockCode& code : row.macroblocks)
            for (int d = 0; d < 2; ++d)
                if (code.type.motion(d)) extent[d].include(code.mode.vector[d]);
    }
    header.intra_vlc_format = gain > 0;
    for (int d = 0; d < 2; ++d)
        if (task.reference[d]) set_f_codes(header.f_code[d], extent[d]);
    return header;
}

/// Writes all rows as slices and joins them behind the header.
std::vector<std::uint8_t> write(const PictureTask& task, const PictureHeader& header, std::vector<RowCode>& rows) {
    std::vector<std::vector<std::uint8_t>> slices(rows.size());
    parallel::for_each(rows.size(), [&](std::size_t row) {
        BitWriter out;
        SliceSyntax syntax{task.type,           task.lines, static_cast<int>(row),
                           rows[row].quantiser, {},         header.intra_vlc_format,
                           header.intra_dc_bits};
        std::copy_n(&header.f_code[0][0], 4, &syntax.f_code[0][0]);
        write_slice(out, syntax, rows[row]);
        slices[row] = out.take();
    });
    BitWriter out;
    write_picture_header(out, header);
    std::vector<std::uint8_t> bytes = out.take();
    for (const auto& slice : slices) bytes.insert(bytes.end(), slice.begin(), slice.end());
    return bytes;
}

/// Fills the public records from the rows; vectors of inter macroblocks predict those of the next picture.
void record(const std::vector<RowCode>& rows, PictureResult& result) {
    for (int row = 0; row < result.records.height(); ++row)
        for (int column = 0; column < result.records.width(); ++column) {
            const MacroblockCode& code =
                rows[static_cast<std::size_t>(row)].macroblocks[static_cast<std::size_t>(column)];
            MacroblockRecord& r = result.records.at(column, row);
            r.intra = code.type.intra;
            r.skipped = code.skipped;
            r.quantiser = code.quantiser;
            r.forward = !r.intra && code.mode.uses[0];
            r.backward = !r.intra && code.mode.uses[1];
            const Vector forward = r.forward ? code.mode.vector[0] : Vector{},
                         backward = r.backward ? code.mode.vector[1] : Vector{};
            r.motion_x = forward.x;
            r.motion_y = forward.y;
            r.backward_x = backward.x;
            r.backward_y = backward.y;
            r.bits = code.bits;
            if (!result.vectors.empty()) result.vectors.at(column, row) = forward;
        }
}

}  // namespace

PictureResult code_picture(const PictureTask& task, const Level& level) {
    const int columns = task.source.columns(), rows = task.source.rows();
    PictureResult result;
    result.reconstruction = Frame(columns, rows);
    result.records = core::Plane<MacroblockRecord>(columns, rows);
    if (task.type == PictureType::predicted) result.vectors = core::Plane<Vector>(columns, rows);
    Vectors vectors;
    const std::optional<MotionSources> sources[2] = {sources_of(task, level, 0), sources_of(task, level, 1)};
    std::optional<FastMotionSearch> fast_search;
    if (task.effort == Effort::fast) {
        fast_search.emplace(sources[0] ? &*sources[0] : nullptr, sources[1] ? &*sources[1] : nullptr);
    } else {
        vectors = choose(task, level, result.motion);
        result.evaluations = result.motion.evaluations.all();
    }
    std::vector<RowCode> decided = decide(task, vectors, fast_search ? &*fast_search : nullptr, result.reconstruction);
    for (const RowCode& row : decided) {
        result.evaluations += row.evaluations;
        result.motion.searches += row.searches;
    }
    result.bytes = write(task, header_for(task, decided), decided);
    record(decided, result);
    return result;
}

}  // namespace render2mpeg::encoder::mpeg2
