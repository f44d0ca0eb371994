#include "app/experiments/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include "app/report/figures.h"
#include "app/system/progress.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// PSNR that stands for pictures that are the same: beyond any 8-bit error.
constexpr double same = 100;

}  // namespace

double size_in_bytes(const std::string& text) {
    char* end = nullptr;
    double value = std::strtod(text.c_str(), &end);
    const bool number = end != text.c_str() && std::isdigit(static_cast<unsigned char>(text[0])) != 0;
    std::string unit(end);
    if (unit.ends_with('B')) unit.pop_back();
    if (unit == "k" || unit == "K")
        value *= 1e3;
    else if (unit == "M")
        value *= 1e6;
    else if (unit == "G")
        value *= 1e9;
    else if (!unit.empty())
        value = -1;
    // chosen: no file system holds more than an exabyte in one file.
    if (!number || !(value >= 1) || value > 1e18)
        throw core::Error("max-size " + text + ": expected bytes as a number, or with k, M or G, e.g. 700M or 4.7G");
    return value;
}

double time_in_seconds(const std::string& text) {
    double seconds = 0, last = 1e9;
    const char* rest = text.c_str();
    bool sound = !text.empty();
    while (*rest != '\0' && sound) {
        char* end = nullptr;
        const double value = std::strtod(rest, &end);
        const double unit = *end == 'h' ? 3600 : *end == 'm' ? 60 : *end == 's' || *end == '\0' ? 1 : 0;
        sound = end != rest && std::isdigit(static_cast<unsigned char>(*rest)) != 0 && unit > 0 && unit < last;
        seconds += value * unit;
        last = unit;
        rest = *end == '\0' ? end : end + 1;
    }
    // chosen: a year is longer than anybody waits.
    if (!sound || !(seconds > 0) || seconds > 3.2e7)
        throw core::Error("max-time " + text + ": expected hours, minutes and seconds, e.g. 2h, 90m, 1h30m or 45s");
    return seconds;
}

std::string figure_text(Target::Kind kind, double value) {
    if (!std::isfinite(value)) return "-";
    switch (kind) {
        case Target::Kind::psnr:
            return value >= same ? "the same" : fmt::format("{:.2f} dB PSNR-Y", value);
        case Target::Kind::ssim:
            return fmt::format("{:.4f} SSIM", value);
        case Target::Kind::bitrate:
            return fmt::format("{:.{}f} kb/s", 1e-3 * value, value < 1e5 ? 1 : 0);
        case Target::Kind::size:
            return size_text(value);
        case Target::Kind::time:
            break;
    }
    return clock_text(value);
}

std::string target_text(const Target& target) {
    if (target.kind == Target::Kind::psnr) return fmt::format("{:g} dB PSNR-Y", target.value);
    if (target.kind == Target::Kind::ssim) return fmt::format("{:g} SSIM", target.value);
    return figure_text(target.kind, target.value);
}

double value_of(const Target& target, const Trial& trial, double pictures_per_second, bool against_references) {
    const Quality quality = quality_of(trial, against_references);
    if (target.kind == Target::Kind::psnr) return std::min(quality.psnr_y, same);
    if (target.kind == Target::Kind::ssim) return quality.ssim_y;
    return 8 * trial.bytes * pictures_per_second;
}

double even_figure(const Target& target, double value) {
    if (target.kind == Target::Kind::psnr) return std::min(value, same);
    if (target.kind == Target::Kind::ssim) return -10 * std::log10(std::max(1 - value, 1e-9));
    return std::log(std::max(value, 1.0));
}

double even_slope(const Target& target) {
    // fit: docs/fits/coupled-share.jsonl: between quantisers 2 and 16 a doubling, 20 of quality, costs 3.7 to 4.7 dB
    // and 0.35 to 0.43 of the bits.
    return target.is_rate() ? 0.025 : 0.2;
}

bool is_lossless(const Target& target, double value) {
    // chosen: what rounding leaves of an SSIM of 1.
    return target.kind == Target::Kind::psnr ? value >= same : target.kind == Target::Kind::ssim && value > 1 - 1e-9;
}

bool is_near(const Target& target, double value, double share) {
    if (target.kind == Target::Kind::psnr) return std::abs(value - target.value) <= share * near_psnr;
    if (target.kind == Target::Kind::ssim) return std::abs(value - target.value) <= share * near_ssim;
    return std::abs(value / target.value - 1) <= share * near_rate;
}

}  // namespace render2mpeg::app
