#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/trial.h"

namespace render2mpeg::app {

/// One way from a scene to a film, by quantiser.
struct Way {
    std::string name;
    std::string how;  ///< the command, or what stands for it
    std::vector<Trial> rows;
};

/// All that `compare` finds out.
struct Comparison {
    std::vector<Chunk> windows;
    int references = 0;
    double reference_seconds = 0;  ///< CPU for light, each
    std::size_t light_points = 0;
    std::string ffmpeg;  ///< its version
    /// Coupled; a fixed 2 % with this program's encoder, with ffmpeg, and with ffmpeg's strongest command.
    std::vector<Way> ways;
    bool complete = false;  ///< false: interrupted
};
inline constexpr std::size_t coupled_way = 0, fixed_way = 1, usual_way = 2, strongest_way = 3;

/// How a way differs from another at equal quality, in per cent; NaN where they have no quality in common (bd_rate.h).
struct Difference {
    double psnr_y = 0, ssim_y = 0, psnr_hvs_m = 0;
    double seconds = 0;  ///< CPU for light, motion and coding, at equal PSNR-Y
};
/// In bits, and in time.
Difference difference_of(const Way& way, const Way& from);

/// The comparison in a sentence or two; empty where it is not complete.
std::string sentence_of(const Comparison& found);

/// Lines of at most 80 columns, each with its end.
std::string compare_heading(const Production& film, const Comparison& found);
std::string way_heading();
std::string way_row(const std::string& name, const Trial& trial);
std::string difference_table(const Comparison& found);

/// "-12.3 %", or "-" where it is not known.
std::string change_text(double per_cent);

}  // namespace render2mpeg::app
