#include "encoder/mpeg2/bitstream/levels.h"

#include <algorithm>
#include <array>
#include <string>

#include "encoder/cadence.h"

namespace render2mpeg::encoder {
namespace mpeg2 {
namespace {

constexpr std::array<Level, 3> levels = {{
    {"Main", 8, 720, 576, 30, 10'368'000, 15'000'000, 1'835'008, 8},
    {"High-1440", 6, 1440, 1152, 60, 47'001'600, 60'000'000, 7'340'032, 9},
    {"High", 4, 1920, 1152, 60, 62'668'800, 80'000'000, 9'781'248, 9},
}};

constexpr std::int64_t rate_unit = 400, buffer_unit = 16'384;  // of bit_rate and vbv_buffer_size [H262, 6.3.3]

/// Share of the buffer that is full where a chunk begins. More lets its first picture have more bits, and lets the last
/// pictures of the chunk before have fewer.
/// chosen: 0.8; tried 0.6..0.9.
constexpr double chunk_fullness_share = 0.8;

/// Pictures of a GOP. MPEG-2 has no limit; what an endless chunk may cost is looked ahead for a GOP.
/// chosen: more than an hour at 25 Hz.
constexpr int most_gop = 100'000;

std::int64_t whole_macroblocks(int size) {
    return (static_cast<std::int64_t>(size) + 15) / 16 * 16;
}

/// Luma samples per second, rounded up.
std::int64_t samples_per_second(const Settings& s) {
    const core::Rational hertz = declared_rate(s).hertz;
    return (whole_macroblocks(s.width) * whole_macroblocks(s.height) * hertz.num + hertz.den - 1) / hertz.den;
}

std::string size_of(const Settings& s) {
    return std::to_string(s.width) + "x" + std::to_string(s.height);
}

void check_range(const char* what, int value, int low, int high) {
    if (value >= low && value <= high) return;
    throw core::Error(std::string(what) + " " + std::to_string(value) + ": must be " + std::to_string(low) + ".." +
                      std::to_string(high));
}

/// Checks that MPEG-2 has pixels of this shape [H262, table 6-3].
void check_shape(const Settings& s) {
    if (s.aspect_ratio_code >= 1 && s.aspect_ratio_code <= 4) return;
    const core::Rational shown = core::product(s.pixel_aspect, {s.width, s.height});
    throw core::Error("pixels of " + core::text_of(s.pixel_aspect) + " in a picture of " + size_of(s) + ", shown as " +
                      core::text_of(shown) +
                      ": MPEG-2 has square ones, and pictures of 4:3, 16:9 and 2.21:1; other codecs have any (--codec "
                      "h264)");
}

/// Checks the user's rate settings, each where it has a meaning.
void check_rates(const Settings& s) {
    const RateControl& r = s.rate_control;
    const bool rated = r.mode == RateMode::variable || r.mode == RateMode::constant;
    if (!(r.quality >= 0 && r.quality <= 100)) throw core::Error("quality: must be 0..100");
    if (rated && r.bit_rate < rate_unit)
        throw core::Error("bit rate " + std::to_string(r.bit_rate) + ": must be at least 400 bits per second");
    if (r.max_rate < 0 || (r.max_rate > 0 && r.max_rate < rate_unit))
        throw core::Error("highest bit rate " + std::to_string(r.max_rate) + ": must be at least 400 bits per second");
    if (rated && r.max_rate > 0 && r.max_rate < r.bit_rate)
        throw core::Error("highest bit rate " + std::to_string(r.max_rate) + " is below the bit rate " +
                          std::to_string(r.bit_rate));
    if (r.mode == RateMode::constant && r.max_rate > r.bit_rate)
        throw core::Error("highest bit rate " + std::to_string(r.max_rate) + " with the constant bit rate " +
                          std::to_string(r.bit_rate) + ": they must be equal");
    if (r.buffer_bits < 0 || (r.buffer_bits > 0 && r.buffer_bits < buffer_unit))
        throw core::Error("VBV buffer " + std::to_string(r.buffer_bits) + " bits: must be at least 16384");
}

/// Whether a level brings the wanted bits and holds them.
bool carries(const Level& level, const Settings& s) {
    const RateControl& r = s.rate_control;
    const bool rated = r.mode == RateMode::variable || r.mode == RateMode::constant;
    return std::max(rated ? r.bit_rate : 0, r.max_rate) <= level.bit_rate && r.buffer_bits <= level.buffer_bits;
}

void check_ranges(const Settings& s) {
    if (s.width < 1 || s.height < 1) throw core::Error("size " + size_of(s) + ": both sides must be at least 1");
    check_range("quantiser", s.quantiser, 1, 31);
    if (s.gop < 1) throw core::Error("gop " + std::to_string(s.gop) + ": must be at least 1");
    if (s.gop > most_gop)
        throw core::Error("gop " + std::to_string(s.gop) + ": must be at most " + std::to_string(most_gop));
    check_rates(s);
    check_range("B pictures in a row", s.b_pictures, 0, 3);
    check_shape(s);
    if (s.transfer_characteristics != 1 && s.transfer_characteristics != 2)
        throw core::Error("transfer characteristics " + std::to_string(s.transfer_characteristics) +
                          ": expected 1 (BT.709) or 2 (unspecified)");
    if (s.matrix_coefficients != 1 && s.matrix_coefficients != 6)
        throw core::Error("matrix coefficients " + std::to_string(s.matrix_coefficients) +
                          ": must be 1 (BT.709) or 6 (BT.601)");
    if (s.cadence == Cadence::pulldown && s.rate.code != 1 && s.rate.code != 2)
        throw core::Error("frame rate " + std::string(s.rate.name) +
                          " with repeated fields: must be 23.976 or 24, which are shown at 29.97 and 30 Hz");
    std::string list;
    for (const core::FrameRate& rate : core::mpeg2_frame_rates()) {
        if (rate.code == s.rate.code && rate.hertz == s.rate.hertz) return;
        list += (list.empty() ? "" : ", ") + rate.name;
    }
    throw core::Error("frame rate " + s.rate.name + ": MPEG-2 has " + list +
                      " pictures a second; other codecs have any (--codec h264)");
}

}  // namespace

std::span<const Level> all_levels() {
    return levels;
}

const Level& level_for(const Settings& s) {
    check_ranges(s);
    const std::int64_t samples = samples_per_second(s);
    const core::Rational hertz = declared_rate(s).hertz;
    for (const Level& level : levels)
        if (s.width <= level.width && s.height <= level.height && hertz.num <= level.hertz * hertz.den &&
            samples <= level.samples && carries(level, s))
            return level;

    // Name the limit of the highest level that is broken.
    const Level& high = levels.back();
    if (s.rate_control.bit_rate > high.bit_rate || s.rate_control.max_rate > high.bit_rate)
        throw core::Error("bit rate " + std::to_string(std::max(s.rate_control.bit_rate, s.rate_control.max_rate)) +
                          ": MPEG-2's High level allows at most " + std::to_string(high.bit_rate));
    if (s.rate_control.buffer_bits > high.buffer_bits)
        throw core::Error("VBV buffer " + std::to_string(s.rate_control.buffer_bits) +
                          " bits: MPEG-2's High level allows at most " + std::to_string(high.buffer_bits));
    const std::string doing = "size " + size_of(s) + " at " + s.rate.name + " Hz: MPEG-2's High level allows at most ";
    if (s.width > high.width) throw core::Error(doing + std::to_string(high.width) + " columns");
    if (s.height > high.height) throw core::Error(doing + std::to_string(high.height) + " lines");
    throw core::Error(doing + std::to_string(high.samples) + " luma samples per second; these are " +
                      std::to_string(samples) + " (sides count in whole macroblocks of 16)");
}

int macroblock_rows(const Settings& s) {
    return s.cadence == Cadence::frames ? (s.height + 15) / 16 : 2 * ((s.height + 31) / 32);
}

Channel channel_for(const Settings& settings, const Level& level) {
    const RateControl& wanted = settings.rate_control;
    Channel channel{};
    channel.constant = wanted.mode == RateMode::constant;
    const std::int64_t rate = channel.constant ? wanted.bit_rate : wanted.max_rate;
    channel.bit_rate = (rate > 0 ? rate : level.bit_rate) / rate_unit * rate_unit;
    channel.average_rate =
        wanted.mode == RateMode::variable ? std::min(wanted.bit_rate, channel.bit_rate) : channel.bit_rate;

    // A full buffer lasts no longer than vbv_delay can say, one below the value that means "variable".
    const std::int64_t expressible = channel.constant ? 65'534 * channel.bit_rate / 90'000 : level.buffer_bits;
    const std::int64_t buffer = wanted.buffer_bits > 0 ? wanted.buffer_bits : std::min(level.buffer_bits, expressible);
    channel.buffer_bits = std::max<std::int64_t>(1, buffer / buffer_unit) * buffer_unit;
    channel.usable_bits = channel.buffer_bits;
    // vbv_delay is rounded up, so that decoders who start by it may find a tick's bits more than they should.
    if (channel.constant)
        channel.usable_bits =
            std::max<std::int64_t>(0, std::min(channel.buffer_bits - channel.bit_rate / 90'000 - 16, expressible));
    channel.chunk_fullness = static_cast<std::int64_t>(chunk_fullness_share * static_cast<double>(channel.usable_bits));
    return channel;
}

}  // namespace mpeg2
}  // namespace render2mpeg::encoder
