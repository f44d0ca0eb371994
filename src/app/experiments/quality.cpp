#include "app/experiments/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

/// Mean squared errors add up, as far as coding and light err independently.
double sum_of(double shown, double there, double decoded) {
    const auto error = [](double psnr) { return std::isfinite(psnr) ? std::pow(10.0, -0.1 * psnr) : 0.0; };
    const double sum = std::max(0.0, error(shown) + error(decoded) - error(there));
    return sum > 0 ? -10 * std::log10(sum) : std::numeric_limits<double>::infinity();
}

}  // namespace

Quality with_light(const Quality& shown, const Quality& there, const Quality& decoded) {
    return {sum_of(shown.psnr_y, there.psnr_y, decoded.psnr_y),
            std::clamp(shown.ssim_y + decoded.ssim_y - there.ssim_y, -1.0, 1.0),
            sum_of(shown.psnr_hvs_m, there.psnr_hvs_m, decoded.psnr_hvs_m)};
}

Quality quality_of(const Trial& trial, bool against_references) {
    const auto of = [](const perceptual::FilmQuality& q, double masked) {
        return Quality{q.psnr_y(), q.ssim_y(), perceptual::psnr(masked)};
    };
    const Quality shown = of(trial.shown, trial.shown_masked);
    if (!against_references) return shown;
    return with_light(shown, of(trial.shown_there, trial.shown_masked_there), of(trial.decoded, trial.masked_error));
}

}  // namespace render2mpeg::app
