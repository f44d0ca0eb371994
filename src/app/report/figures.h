#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

/// "0:16 (28 s of CPU)": by the clock, and of all threads.
std::string time_text(double clock, double cpu);

/// One of several ways to the same film, as the rule of all pages sees it.
struct Offer {
    double cost = 0;            ///< of any unit, the same for all
    bool is_like_best = false;  ///< indistinguishable from the best
};

/// The recommended one: the cheapest indistinguishable from the best. None where there is none.
std::optional<std::size_t> cheapest_alike(std::span<const Offer> offers);

}  // namespace render2mpeg::app
