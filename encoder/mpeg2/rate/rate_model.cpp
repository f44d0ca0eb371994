#include "encoder/mpeg2/rate/rate_model.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/numeric.h"
#include "encoder/mpeg2/bitstream/tuning.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

std::size_t index_of(PictureType type) {
    return static_cast<std::size_t>(type) - 1;
}

/// Complexities of P and B pictures over that of an I picture, where only the latter is known.
/// fit: docs/measurements.md#rates
constexpr double complexity_ratio[3] = {1.0, 0.63, 0.28};

/// Bits per luma sample of an I picture at quantiser 1. fit: docs/measurements.md#rates
constexpr double guessed_density = 2.2;

/// A picture that takes this many times the bits expected is no odd one among its like: the film has become harder.
/// chosen: 2 of 1.5 to 4 (docs/measurements.md#encoder).
constexpr double surprise = 2;

/// The geometric mean of old and new: one odd picture is half forgotten with the next.
double blended(const std::optional<double>& old, double now) {
    return old ? std::sqrt(*old * now) : now;
}

}  // namespace

double quantiser_ratio(PictureType type, std::int64_t followers) {
    if (type == PictureType::bidirectional) return quantiser_ratio_bidirectional;
    return std::pow(1.0 + static_cast<double>(std::min(followers, most_followers)), -propagation_strength);
}

double ratio_of(const PicturePlan& picture) {
    return quantiser_ratio(picture.type, picture.horizon.value_or(picture.number) - picture.number);
}

double usual_quantiser_ratio(PictureType type, int gop) {
    return quantiser_ratio(type, type == PictureType::intra ? gop - 1 : gop / 2);
}

double rate_slope(PictureType type) {
    constexpr double slopes[3] = {0.7, 0.95, 0.85};
    return slopes[index_of(type)];
}

RateModel::RateModel(const Settings& settings, const MinimalBits& minimal)
    : overhead_{static_cast<double>(minimal.intra), static_cast<double>(minimal.other),
                static_cast<double>(minimal.other)},
      first_guess_(guessed_density * settings.width * settings.height) {}

double RateModel::complexity(PictureType type) const {
    const std::size_t i = index_of(type);
    if (learned_[i]) return *learned_[i];
    if (expected_[i]) return *expected_[i];
    // Another type tells something of this one; the nearer type is asked first.
    for (const std::size_t other : {std::size_t{1}, std::size_t{2}, std::size_t{0}})
        if (learned_[other]) return *learned_[other] * complexity_ratio[i] / complexity_ratio[other];
    return first_guess_ * complexity_ratio[i];
}

double RateModel::bits(PictureType type, double quantiser) const {
    return overhead_[index_of(type)] + complexity(type) * std::pow(quantiser, -rate_slope(type));
}

bool RateModel::surprised(PictureType type, int quantiser, std::int64_t bits) const {
    const double overhead = overhead_[index_of(type)];
    return knows(type) && static_cast<double>(bits) - overhead > surprise * (this->bits(type, quantiser) - overhead);
}

/// Complexity of a picture. One of nothing at all still has one to be blended and divided by: one bit.
double RateModel::detail(PictureType type, int quantiser, double bits) const {
    return std::max(1.0, bits - overhead_[index_of(type)]) * std::pow(quantiser, rate_slope(type));
}

void RateModel::expect(PictureType type, int quantiser, double bits) {
    std::optional<double>& expected = expected_[index_of(type)];
    expected = blended(expected, detail(type, quantiser, bits));
}

void RateModel::learn(PictureType type, int quantiser, std::int64_t bits) {
    const std::size_t i = index_of(type);
    const double now = detail(type, quantiser, static_cast<double>(bits));
    learned_[i] = surprised(type, quantiser, bits) ? now : blended(learned_[i], now);
}

double PassModel::bits(PictureType type, const BitAllocation& allocation, double quantiser) const {
    const PictureType then = allocation.type.value_or(type);
    const double ratio = learned_[index_of(then)][index_of(type)].value_or(excess());
    return ratio * allocation.bits * std::pow(allocation.quantiser / quantiser, rate_slope(type));
}

void PassModel::learn(PictureType type, const BitAllocation& allocation, int quantiser, std::int64_t bits) {
    const std::size_t then = index_of(allocation.type.value_or(type));
    const double expected = allocation.bits * std::pow(allocation.quantiser / quantiser, rate_slope(type));
    const double real = std::max(1.0, static_cast<double>(bits));
    std::optional<double>& learned = learned_[then][index_of(type)];
    learned = blended(learned, real / std::max(1.0, expected));

    // chosen: half forgotten after ten pictures, most of a GOP (5..40).
    constexpr double fading = 0.933;
    for (std::size_t i = 0; i < 3; ++i) real_[i] *= fading, expected_[i] *= fading;
    real_[then] += real;
    expected_[then] += expected;
}

double PassModel::excess(PictureType then) const {
    return core::divide_or(real_[index_of(then)], expected_[index_of(then)], excess());
}

double PassModel::excess() const {
    return core::divide_or(real_[0] + real_[1] + real_[2], expected_[0] + expected_[1] + expected_[2], 1.0);
}

}  // namespace render2mpeg::encoder::mpeg2
