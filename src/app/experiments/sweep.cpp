#include "app/experiments/sweep.h"

#include <fmt/format.h>

#include <cmath>

namespace render2mpeg::app {

std::optional<double> CoupledPair::time_ratio() const {
    if (!(coupled.seconds > 0 && fixed.seconds > 0) || fixed.points == 0) return std::nullopt;
    return coupled.seconds / fixed.seconds;
}

std::optional<double> CoupledPair::psnr_loss() const {
    const double loss = fixed.decoded.psnr_y() - coupled.decoded.psnr_y();
    return std::isfinite(loss) ? std::optional(loss) : std::nullopt;
}

std::string tolerance_text(float share) {
    return fmt::format("{:.4g} %", 100 * share);
}

std::string short_figure(double value) {
    if (!std::isfinite(value)) return "-";
    if (value >= 999.5) return fmt::format("{:.0f}", value);
    if (value < 0.0005) return "0";
    const int digits = value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
    return fmt::format("{:.{}f}", value, value < 0.095 ? 3 : digits);
}

}  // namespace render2mpeg::app
