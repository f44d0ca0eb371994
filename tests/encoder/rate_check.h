#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/rational.h"
#include "encoder/types.h"
#include "rate_stream.h"

/// What the standard demands of a stream, checked on the bytes alone.
namespace render2mpeg::encoder::testing {

struct LevelLimits {
    int indication;
    std::int64_t bit_rate, buffer_bits;
    int horizontal_f_code;
    int width, height;
    double hertz, samples;  ///< per second
};
/// [H262, tables 8-11 to 8-14]
inline LevelLimits limits_of(int indication) {
    if (indication == 8) return {8, 15'000'000, 1'835'008, 8, 720, 576, 30, 10'368'000};
    if (indication == 6) return {6, 60'000'000, 7'340'032, 9, 1440, 1152, 60, 47'001'600};
    return {4, 80'000'000, 9'781'248, 9, 1920, 1152, 60, 62'668'800};
}

/// Seconds between the removals of each picture and the next, from what the stream says of its fields: a B picture is
/// shown when it is taken out, others when the next one of them is. [H262, C.3.1]
inline std::vector<double> removal_steps(const ReadStream& stream) {
    const double field =
        0.5 / core::mpeg2_frame_rates()[static_cast<std::size_t>(stream.frame_rate_code - 1)].hertz.value();
    std::vector<double> steps;
    bool repeats = false;  // of the I or P picture before
    for (const ReadPicture& p : stream.pictures) {
        const bool shown = p.type == 3 ? p.repeat_first_field : repeats;
        steps.push_back(field * (shown ? 3 : 2));
        if (p.type != 3) repeats = p.repeat_first_field;
    }
    return steps;
}

/// With vbv_delay in every header: each picture has arrived when it is taken out, none too many have, and every delay
/// is the true one. Decoders may start anywhere. [H262, C.3.1]
inline std::string check_constant(const ReadStream& stream) {
    const std::vector<double> steps = removal_steps(stream);
    const auto rate = static_cast<double>(stream.bit_rate);
    const auto arrival = [&](std::size_t byte) { return 8.0 * static_cast<double>(byte) / rate; };
    // Each delay tells a time of the first removal: the earliest and the latest of all.
    double earliest = 1e30, latest = -1e30, elapsed = 0;
    for (std::size_t i = 0; i < stream.pictures.size(); ++i) {
        const ReadPicture& p = stream.pictures[i];
        const double told = arrival(p.after_start_code) + p.vbv_delay / 90'000.0 - elapsed;
        earliest = std::min(earliest, told);
        latest = std::max(latest, told);
        elapsed += steps[i];
    }
    if (latest - earliest > 1.0 / 90'000.0 + 1e-9) return "the delays contradict each other";

    elapsed = 0;
    std::size_t removed = 0;
    for (std::size_t i = 0; i < stream.pictures.size(); ++i) {
        const ReadPicture& p = stream.pictures[i];
        const std::string where = " at picture " + std::to_string(i);
        if (arrival(p.end) > earliest + elapsed + 1e-9) return "underflow" + where;
        const double held = (latest + elapsed) * rate - 8.0 * static_cast<double>(removed);
        const double whole = 8.0 * static_cast<double>(stream.pictures.back().end - removed);
        if (std::min(held, whole) > static_cast<double>(stream.buffer_bits) + 1e-3) return "overflow" + where;
        removed = p.end;
        elapsed += steps[i];
    }
    return {};
}

/// Without: bits come at the highest rate until the buffer is full, and decoding begins when it first is.
/// [H262, C.3.2]
inline std::string check_variable(const ReadStream& stream) {
    const std::vector<double> steps = removal_steps(stream);
    const auto size = static_cast<double>(stream.buffer_bits);
    double fullness = size;
    for (std::size_t i = 0; i < stream.pictures.size(); ++i) {
        const ReadPicture& p = stream.pictures[i];
        fullness -= 8.0 * static_cast<double>(p.end - p.first_byte);
        if (fullness < -1e-3) return "underflow at picture " + std::to_string(i);
        fullness = std::min(size, fullness + steps[i] * static_cast<double>(stream.bit_rate));
    }
    return {};
}

/// The decoder's buffer once more, from the sizes and flags in the stream alone, beginning with the fullness that is
/// declared: what the encoder reports of it must be so. Chunks begin at these places in coding order.
inline std::string check_reported(const ReadStream& stream, const std::vector<CodedPicture>& coded,
                                  const std::vector<std::size_t>& chunk_starts, const Declaration& declared,
                                  bool constant) {
    const std::vector<double> steps = removal_steps(stream);
    if (declared.bit_rate != stream.bit_rate || declared.buffer_bits != stream.buffer_bits)
        return "headers do not say what was declared";
    // A constant rate counts the part of a byte that has arrived at a chunk's border.
    const double fullness_slack = constant ? 8 : 0;
    double fullness = 0;
    for (std::size_t i = 0; i < coded.size(); ++i) {
        const std::string where = " at picture " + std::to_string(i);
        const auto differs = [&](std::int64_t reported) {
            return std::abs(std::floor(fullness + 1e-6) - static_cast<double>(reported)) > 1;
        };
        if (std::find(chunk_starts.begin(), chunk_starts.end(), i) != chunk_starts.end()) {
            const auto begin = static_cast<double>(coded[i].fullness_before),
                       border = static_cast<double>(declared.chunk_fullness);
            if (begin < border || begin > border + fullness_slack) return "another fullness than declared" + where;
            if (i > 0 && (constant ? differs(coded[i].fullness_before) : fullness < begin - 1e-3))
                return "a chunk does not hand over what the next one finds" + where;
            if (!constant || i == 0) fullness = begin;
        }
        if (differs(coded[i].fullness_before)) return "another fullness before" + where;
        fullness -= 8.0 * static_cast<double>(stream.pictures[i].end - stream.pictures[i].first_byte);
        if (fullness < -1) return "underflow" + where;
        if (differs(coded[i].fullness_after)) return "another fullness after" + where;
        fullness += steps[i] * static_cast<double>(stream.bit_rate);
        if (!constant) fullness = std::min(fullness, static_cast<double>(stream.buffer_bits));
        if (fullness > static_cast<double>(stream.buffer_bits)) return "overflow" + where;
        if (differs(coded[i].fullness_next)) return "another fullness when the next is taken" + where;
    }
    return {};
}

/// Everything at once; empty: nothing is wrong.
inline std::string check_stream(const ReadStream& stream, bool constant) {
    const LevelLimits limits = limits_of(stream.level);
    if (stream.bit_rate > limits.bit_rate) return "the bit rate exceeds the level's";
    if (stream.buffer_bits > limits.buffer_bits) return "the buffer exceeds the level's";
    const double hertz = core::mpeg2_frame_rates()[static_cast<std::size_t>(stream.frame_rate_code - 1)].hertz.value();
    if (stream.width > limits.width || stream.height > limits.height) return "the size exceeds the level's";
    if (hertz > limits.hertz) return "the picture rate exceeds the level's";
    const int columns = (stream.width + 15) / 16;
    const int rows = stream.progressive ? (stream.height + 15) / 16 : 2 * ((stream.height + 31) / 32);
    if (256.0 * columns * ((stream.height + 15) / 16) * hertz > limits.samples)
        return "the samples per second exceed the level's";
    for (std::size_t i = 0; i < stream.pictures.size(); ++i) {
        const ReadPicture& p = stream.pictures[i];
        const std::string where = " in picture " + std::to_string(i);
        if (p.macroblocks != columns * rows) return "macroblocks are missing" + where;
        if (p.largest_macroblock > 4608) return "a macroblock has more than 4608 bits" + where;
        for (int k = 0; k < 4; ++k) {
            const bool used = k / 2 < p.type - 1;
            const int most = k % 2 == 0 ? limits.horizontal_f_code : 5;
            if (used ? p.f_code[k] < 1 || p.f_code[k] > most : p.f_code[k] != 15) return "f_code" + where;
        }
        if (constant == (p.vbv_delay == 0xffff)) return "vbv_delay is of the other kind" + where;
        if (p.has_sequence_header != (p.type == 1)) return "sequence headers do not stand before GOPs" + where;
    }
    return constant ? check_constant(stream) : check_variable(stream);
}

}  // namespace render2mpeg::encoder::testing
