#include "app/experiments/target.h"

#include <fmt/format.h>

#include <algorithm>
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
    const char* whose = target.worst_tenth ? " of the worst tenth" : "";
    if (target.kind == Target::Kind::psnr) return fmt::format("{:g} dB PSNR-Y{}", target.value, whose);
    if (target.kind == Target::Kind::ssim) return fmt::format("{:g} SSIM{}", target.value, whose);
    return figure_text(target.kind, target.value);
}

double value_of(const Target& target, const Trial& trial, double pictures_per_second, bool against_references) {
    const Quality quality = quality_of(trial, against_references);
    if (target.kind == Target::Kind::psnr) return std::min(quality.psnr_y, same);
    if (target.kind == Target::Kind::ssim) return quality.ssim_y;
    return 8 * trial.bytes_in_film() * pictures_per_second;
}

double even_figure(const Target& target, double value) {
    if (target.kind == Target::Kind::psnr) return std::min(value, same);
    if (target.kind == Target::Kind::ssim) return -10 * std::log10(std::max(1 - value, 1e-9));
    return std::log(std::max(value, 1.0));
}

double even_slope(const Target& target) {
    // fit: bench/fits/coupled-share.jsonl: between quantisers 2 and 16 a doubling, 20 of quality, costs 3.7 to 4.7 dB
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
