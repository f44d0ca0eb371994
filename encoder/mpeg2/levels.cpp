#include "encoder/mpeg2/levels.h"

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

void check_ranges(const Settings& s) {
    if (s.width < 1 || s.height < 1) throw core::Error("size " + size_of(s) + ": both sides must be at least 1");
    check_range("quantiser", s.quantiser, 1, 31);
    if (s.gop < 1) throw core::Error("gop " + std::to_string(s.gop) + ": must be at least 1");
    check_range("B pictures in a row", s.b_pictures, 0, 3);
    check_range("aspect ratio code", s.aspect_ratio_code, 1, 4);
    if (s.matrix_coefficients != 1 && s.matrix_coefficients != 6)
        throw core::Error("matrix coefficients " + std::to_string(s.matrix_coefficients) +
                          ": must be 1 (BT.709) or 6 (BT.601)");
    if (s.cadence == Cadence::pulldown && s.rate.code != 1 && s.rate.code != 2)
        throw core::Error("frame rate " + std::string(s.rate.name) +
                          " with repeated fields: must be 23.976 or 24, which are shown at 29.97 and 30 Hz");
    for (const core::FrameRate& rate : core::mpeg2_frame_rates())
        if (rate.code == s.rate.code && rate.hertz == s.rate.hertz) return;
    throw core::Error("frame rate code " + std::to_string(s.rate.code) + ": MPEG-2 has no such rate");
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
            samples <= level.samples)
            return level;

    // Name the limit of the highest level that is broken.
    const Level& high = levels.back();
    const std::string doing = "size " + size_of(s) + " at " + s.rate.name + " Hz: MPEG-2's High level allows at most ";
    if (s.width > high.width) throw core::Error(doing + std::to_string(high.width) + " columns");
    if (s.height > high.height) throw core::Error(doing + std::to_string(high.height) + " lines");
    throw core::Error(doing + std::to_string(high.samples) + " luma samples per second; these are " +
                      std::to_string(samples) + " (sides count in whole macroblocks of 16)");
}

BufferWatch::BufferWatch(const Level& level, const core::FrameRate& rate)
    : size_(static_cast<double>(level.buffer_bits)),
      per_picture_(static_cast<double>(level.bit_rate) / rate.hertz.value()),
      fullness_(size_) {}

bool BufferWatch::remove(std::uint64_t bits) {
    const double left = fullness_ - static_cast<double>(bits);
    fullness_ = std::min(size_, std::max(0.0, left) + per_picture_);
    return left >= 0;
}

}  // namespace mpeg2

void check(const Settings& settings) {
    mpeg2::level_for(settings);
}

}  // namespace render2mpeg::encoder
