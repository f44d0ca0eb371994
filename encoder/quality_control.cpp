#include "encoder/quality_control.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/error.h"

namespace render2mpeg::encoder {
namespace {

/// Exponent of the masked error by the quantiser.
/// fit: bench/tables/encoder.csv
constexpr double error_slope = 2.0;

/// Masked error of a film's mean picture over that of an I, P and B picture of it, at the same base quantiser.
/// fit: bench/tables/encoder.csv
constexpr std::array<double, 3> mean_over_type{1.2, 1.0, 1.0};

/// chosen: what is known of the film fades by a tenth with each picture (0.05 to 0.2).
constexpr double fading = 0.9;

/// chosen: what was shown fades by a thirtieth with each picture, and is made good for within as many as a short GOP
/// has (8 to 30).
constexpr double fading_of_shown = 0.97, horizon = 12;

}  // namespace

double psnr_of_quality(double quality) {
    return 28 + 0.3 * quality;
}

QualityControl::QualityControl(double quality)
    : wanted_(255.0 * 255.0 * std::pow(10.0, -psnr_of_quality(quality) / 10)),
      usual_(std::exp2((100.0 - quality) / 20.0)) {}

double QualityControl::factor() const {
    if (weight_ == 0 || density_ <= 0) return 1;
    // Make good for what was shown too well or too badly, up to a factor of 2.
    const double next = std::clamp(wanted_ + (wanted_ * pictures_ - shown_) / horizon, 0.5 * wanted_, 2 * wanted_);
    const double base = std::pow(next / (density_ / weight_), 1 / error_slope);
    return std::clamp(base / usual_, 0.2, 5.0);
}

void QualityControl::learn(PictureType type, double base, double masked_error) {
    EXPECTS(base > 0 && masked_error >= 0);
    density_ = fading * density_ +
               masked_error * mean_over_type[static_cast<std::size_t>(type) - 1] / std::pow(base, error_slope);
    weight_ = fading * weight_ + 1;
    shown_ = fading_of_shown * shown_ + masked_error;
    pictures_ = fading_of_shown * pictures_ + 1;
}

void QualityControl::expect(const QualityControl& trial) {
    density_ = trial.density_;
    weight_ = trial.weight_;
}

void QualityControl::forget() {
    density_ = weight_ = 0;
}

}  // namespace render2mpeg::encoder
