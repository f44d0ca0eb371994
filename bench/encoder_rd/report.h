#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "encoder_rd/codecs.h"

namespace render2mpeg::bench {

/// What one codec did with one clip, a point for each quantiser.
struct Curve {
    std::string clip, codec;
    std::vector<Measured> points;
};

/// Which codec is held against which.
struct Comparison {
    std::string test, anchor;
};

/// Those that the README reports, as far as both their codecs were measured.
std::vector<Comparison> comparisons_among(const std::vector<Curve>& curves);

/// Every point: rate, quality, bits and quality by picture type, speed.
std::string points_text(const std::vector<Curve>& curves);

/// Bjontegaard differences of rate per clip and their means, as a Markdown table; speeds are ratios within this run.
std::string table(const std::vector<Curve>& curves);

/// How far clips coded alike are from their mean PSNR-HVS-M (standard deviation), as a Markdown table.
std::string deviations(const std::vector<Curve>& curves);

/// The same and every point, for other programs.
void write_json(const std::filesystem::path& file, const std::vector<Curve>& curves);

/// `folder/<clip>.svg` for every clip: quality over rate, one panel per measure.
void write_plots(const std::filesystem::path& folder, const std::vector<Curve>& curves);

}  // namespace render2mpeg::bench
