#include "encoder/av/levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/error.h"
#include "encoder/codec.h"

namespace render2mpeg::av {
namespace {

constexpr std::int64_t macroblock = 256;

/// [H264, tables ]: in macroblocks a second, of a picture and of the buffer, and kb/s; High profile has 1.25
/// times those. A side has at most the square root of 8 pictures, in macroblocks.
constexpr Level h264(int tenths, std::int64_t rate, std::int64_t picture, std::int64_t buffer, std::int64_t kilobits,
                     int side) {
    return {tenths,    picture * macroblock, rate * macroblock, kilobits * 1250, 16 * side,
            16 * side, buffer * macroblock};
}
constexpr std::array h264_levels{h264(10, 1485, 99, 396, 64, 28),
                                 h264(11, 3000, 396, 900, 192, 56),
                                 h264(12, 6000, 396, 2376, 384, 56),
                                 h264(13, 11880, 396, 2376, 768, 56),
                                 h264(20, 11880, 396, 2376, 2000, 56),
                                 h264(21, 19800, 792, 4752, 4000, 79),
                                 h264(22, 20250, 1620, 8100, 4000, 113),
                                 h264(30, 40500, 1620, 8100, 10000, 113),
                                 h264(31, 108000, 3600, 18000, 14000, 169),
                                 h264(32, 216000, 5120, 20480, 20000, 202),
                                 h264(40, 245760, 8192, 32768, 20000, 256),
                                 h264(41, 245760, 8192, 32768, 50000, 256),
                                 h264(42, 522240, 8704, 34816, 50000, 263),
                                 h264(50, 589824, 22080, 110400, 135000, 420),
                                 h264(51, 983040, 36864, 184320, 240000, 543),
                                 h264(52, 2073600, 36864, 184320, 240000, 543),
                                 h264(60, 4177920, 139264, 696320, 240000, 1055),
                                 h264(61, 8355840, 139264, 696320, 480000, 1055),
                                 h264(62, 16711680, 139264, 696320, 800000, 1055)};

/// [H265, tables A.8 and A.9], main tier. A side has at most the square root of 8 pictures.
constexpr Level hevc(int tenths, std::int64_t picture, std::int64_t rate, std::int64_t kilobits, int side) {
    return {tenths, picture, rate, kilobits * 1000, side, side, 0};
}
constexpr std::array hevc_levels{hevc(10, 36864, 552960, 128, 543),
                                 hevc(20, 122880, 3686400, 1500, 991),
                                 hevc(21, 245760, 7372800, 3000, 1402),
                                 hevc(30, 552960, 16588800, 6000, 2103),
                                 hevc(31, 983040, 33177600, 10000, 2804),
                                 hevc(40, 2228224, 66846720, 12000, 4222),
                                 hevc(41, 2228224, 133693440, 20000, 4222),
                                 hevc(50, 8912896, 267386880, 25000, 8444),
                                 hevc(51, 8912896, 534773760, 40000, 8444),
                                 hevc(52, 8912896, 1069547520, 60000, 8444),
                                 hevc(60, 35651584, 1069547520, 60000, 16888),
                                 hevc(61, 35651584, 2139095040, 120000, 16888),
                                 hevc(62, 35651584, 4278190080, 240000, 16888)};

/// [AV1, A.3], main tier.
constexpr Level av1(int tenths, std::int64_t picture, int width, int height, std::int64_t rate, std::int64_t kilobits) {
    return {tenths, picture, rate, kilobits * 1000, width, height, 0};
}
constexpr std::array av1_levels{
    av1(20, 147456, 2048, 1152, 4423680, 1500),         av1(21, 278784, 2816, 1584, 8363520, 3000),
    av1(30, 665856, 4352, 2448, 19975680, 6000),        av1(31, 1065024, 5504, 3096, 31950720, 10000),
    av1(40, 2359296, 6144, 3456, 70778880, 12000),      av1(41, 2359296, 6144, 3456, 141557760, 20000),
    av1(50, 8912896, 8192, 4352, 267386880, 30000),     av1(51, 8912896, 8192, 4352, 534773760, 40000),
    av1(52, 8912896, 8192, 4352, 1069547520, 60000),    av1(53, 8912896, 8192, 4352, 1069547520, 60000),
    av1(60, 35651584, 16384, 8704, 1069547520, 60000),  av1(61, 35651584, 16384, 8704, 2139095040, 100000),
    av1(62, 35651584, 16384, 8704, 4278190080, 160000), av1(63, 35651584, 16384, 8704, 4278190080, 160000)};

std::span<const Level> levels_of(encoder::Codec codec) {
    switch (codec) {
        case encoder::Codec::h264:
            return h264_levels;
        case encoder::Codec::hevc:
            return hevc_levels;
        case encoder::Codec::av1:
            return av1_levels;
        default:
            return {};
    }
}

/// Luma samples of a picture as a codec counts them: H.264 in whole macroblocks.
std::int64_t samples_of(const encoder::Settings& s) {
    if (s.codec != encoder::Codec::h264) return std::int64_t{s.width} * s.height;
    return macroblock * ((s.width + 15) / 16) * ((s.height + 15) / 16);
}

bool holds(const Level& level, const encoder::Settings& s) {
    const double rate = static_cast<double>(samples_of(s)) * s.rate.hertz.value();
    return samples_of(s) <= level.samples && s.width <= level.width && s.height <= level.height &&
           rate <= static_cast<double>(level.rate) && s.rate_control.bit_rate <= level.bits;
}

const Level& level_of(const encoder::Settings& s) {
    const std::span<const Level> levels = levels_of(s.codec);
    const std::string name(encoder::facts_of(s.codec).name);
    const auto lowest = std::ranges::find_if(levels, [&](const Level& level) { return holds(level, s); });
    if (s.level == 0) return lowest == levels.end() ? levels.back() : *lowest;
    const auto asked = std::ranges::find(levels, s.level, &Level::tenths);
    if (asked == levels.end())
        throw core::Error("level " + level_text(s.level) + ": " + name + " has levels from " +
                          level_text(levels.front().tenths) + " to " + level_text(levels.back().tenths) +
                          ", this is none of them");
    if (!holds(*asked, s))
        throw core::Error("level " + level_text(s.level) + ": " + std::to_string(s.width) + "x" +
                          std::to_string(s.height) + " at " + s.rate.name + " Hz" +
                          (s.rate_control.bit_rate > 0 ? " and this bit rate" : "") + " is more than this level of " +
                          name + " holds; " +
                          (lowest == levels.end() ? "no level holds it" : level_text(lowest->tenths) + " does"));
    return *asked;
}

}  // namespace

bool has_levels(encoder::Codec codec) {
    return !levels_of(codec).empty();
}

int level_for(const encoder::Settings& settings) {
    return has_levels(settings.codec) ? level_of(settings).tenths : 0;
}

int references_for(const encoder::Settings& settings) {
    if (settings.codec != encoder::Codec::h264) return 0;
    const int wanted = settings.effort == encoder::Effort::fast ? 1 : 5;  // of the presets "veryfast" and "slow"
    return std::clamp(static_cast<int>(level_of(settings).buffer / samples_of(settings)), 1, wanted);
}

std::int64_t bits_of_level(encoder::Codec codec, const std::string& level) {
    const std::span<const Level> levels = levels_of(codec);
    const auto known = std::ranges::find_if(levels, [&](const Level& l) { return level_text(l.tenths) == level; });
    return known == levels.end() ? 0 : known->bits;
}

std::string level_text(int tenths) {
    return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10);
}

}  // namespace render2mpeg::av
