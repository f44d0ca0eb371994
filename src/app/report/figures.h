#pragma once

#include <cstdint>
#include <string>

/// Figures as people read them.
namespace render2mpeg::app {

/// "1.2 kB", "3.45 MB": powers of 1000.
std::string size_text(double bytes);
/// `41.25` dB, or `same` where two pictures do not differ.
std::string psnr_text(double psnr);
/// "9999", "12.3 k", "4.5 M".
std::string count_text(double count);
/// A share of 1 as "12.3 %".
std::string percent_text(double share);
/// Three digits at most; "-" for non-finite values.
std::string short_figure(double value);
/// "1 picture", "2 pictures".
std::string pictures_text(std::int64_t count);

/// Text that may stand in HTML.
std::string escaped(const std::string& text);

}  // namespace render2mpeg::app
