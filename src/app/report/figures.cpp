#include "app/report/figures.h"

#include <fmt/format.h>

#include <cmath>

#include "app/system/progress.h"

namespace render2mpeg::app {

std::string psnr_text(double psnr) {
    return std::isfinite(psnr) ? fmt::format("{:.2f}", psnr) : "same";
}

std::string size_text(double bytes) {
    if (bytes < 1e3) return fmt::format("{:.0f} B", bytes);
    if (bytes < 1e6) return fmt::format("{:.1f} kB", bytes / 1e3);
    return bytes < 1e9 ? fmt::format("{:.2f} MB", bytes / 1e6) : fmt::format("{:.2f} GB", bytes / 1e9);
}

std::string count_text(double count) {
    if (count < 1e4) return fmt::format("{:.0f}", count);
    if (count < 1e6) return fmt::format("{:.1f} k", count / 1e3);
    return count < 1e9 ? fmt::format("{:.1f} M", count / 1e6) : fmt::format("{:.2f} G", count / 1e9);
}

std::string percent_text(double share) {
    return fmt::format("{:.1f} %", 100 * share);
}

std::string short_figure(double value) {
    if (!std::isfinite(value)) return "-";
    if (value >= 999.5) return fmt::format("{:.0f}", value);
    if (value < 0.0005) return "0";
    const int digits = value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
    return fmt::format("{:.{}f}", value, value < 0.095 ? 3 : digits);
}

std::string pictures_text(std::int64_t count) {
    return fmt::format("{} picture{}", count, count == 1 ? "" : "s");
}

std::optional<std::size_t> cheapest_alike(std::span<const Offer> offers) {
    std::optional<std::size_t> taken;
    for (std::size_t i = 0; i < offers.size(); ++i)
        if (offers[i].is_like_best && (!taken || offers[i].cost < offers[*taken].cost)) taken = i;
    return taken;
}

std::string time_text(double clock, double cpu) {
    return fmt::format("{} ({:.{}f} s of CPU)", clock_text(clock), cpu, cpu < 10 ? 1 : 0);
}

}  // namespace render2mpeg::app
