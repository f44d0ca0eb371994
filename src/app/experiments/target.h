#pragma once

#include <optional>
#include <string>

#include "app/experiments/quality.h"

namespace render2mpeg::app {

/// What `tune` is asked to reach.
struct Target {
    enum class Kind {
        psnr,     ///< dB of luma
        ssim,     ///< of luma
        bitrate,  ///< bits per second of pictures
        size,     ///< bytes of the file, at most
        time,     ///< seconds on the clock, at most
    };
    Kind kind = Kind::psnr;
    double value = 0;
    bool worst_tenth = false;  ///< of the pictures: theirs is the quality that is meant

    bool is_quality() const { return kind == Kind::psnr || kind == Kind::ssim; }
    bool is_rate() const { return kind == Kind::bitrate || kind == Kind::size; }
};

/// How far from a target is near enough: of a quality in its own unit, of a rate as a share of it.
inline constexpr double near_psnr = 0.1, near_ssim = 0.002, near_rate = 0.02;

/// "42 dB PSNR-Y", "0.98 SSIM", "2000 kb/s", "1.20 MB", "1:30:00": what was asked for.
std::string target_text(const Target& target);
/// A value of the target's kind as people read it; none: "-".
std::string figure_text(Target::Kind kind, double value);

/// What a film's pictures come to in the target's kind. Of a size: bits per second, too.
double value_of(const Target& target, const Trial& trial, double pictures_per_second, bool against_references);

/// Where a value lies on a scale on which films' figures rise evenly with --quality: decibels, or the logarithm of a
/// rate. Finite for all values.
double even_figure(const Target& target, double value);
/// By how much that rises for each unit of quality, about.
double even_slope(const Target& target);
/// Whether a value says that nothing is lost at all, so that no coding could be better.
bool is_lossless(const Target& target, double value);
/// Whether a value is as near as is asked for, or within `share` of that.
bool is_near(const Target& target, double value, double share = 1);

}  // namespace render2mpeg::app
