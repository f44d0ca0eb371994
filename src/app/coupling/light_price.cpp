#include "app/coupling/light_price.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/numeric.h"
#include "core/standard_error.h"
#include "renderer/base/allocation.h"

namespace render2mpeg::app {
namespace {

/// Shares that are asked for. chosen: at 2 errors are twice as large as what coding hides, and edges show; below 1/32
/// tolerances end at half a code value.
constexpr double least_share = 1.0 / 32, most_share = 2;

/// Of pictures without noise, such as black ones. chosen: of people's films most lose 0.2 to 0.4 dB by it.
constexpr float share_of_none = 0.5f;

/// A measured share is within so many times the one that light had: noise that a price does not move is to move no
/// price. Not tuned.
constexpr float most_change = 2;

/// Power of the share that standard errors follow. fit: docs/measurements.md#tolerance-fraction, 0.77 and 0.47 told of
/// a kitchen; eq. 3 of docs/model/gathering.md has 0.82.
constexpr double error_power = 0.8;

/// Rays that a variance is told of.
constexpr double batch = 8;

/// Rays that a point is worth whose mean of a batch varies by so much (docs/model/gathering.md, eq. 3).
double worth(double batch_variance, double allowed, const renderer::Allocation& allocation) {
    const double needs = renderer::samples_for(allowed, batch, batch_variance, renderer::variance_power);
    return std::max(allocation.worth(needs), 1.0 * renderer::pilot_rays);
}

double variance_of(double rays, double batch_variance) {
    return batch_variance * std::pow(batch / rays, static_cast<double>(renderer::variance_power));
}

/// Squared standard error that a tolerance, in code values, asks of noise.
double allowed_square(double tolerance) {
    return std::pow(tolerance / static_cast<double>(core::errors_of_noise), 2);
}

}  // namespace

float expected_share(const perceptual::VisibilityModel& model, const perceptual::TemporalState& rough,
                     const core::Radiance& light, double loss) {
    const core::Plane<perceptual::PixelNoise> seen =
        perceptual::noise_of(rough.light, model.light(), light.error, light.shared_error);
    const core::Plane<perceptual::PixelNoise> hidden =
        perceptual::noise_of(rough.light, model.light(), rough.errors, rough.errors);
    // How light varies: the look took first rays alone, but where records were known.
    std::vector<double> batches(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i)
        batches[i] = seen.values()[i].alone / variance_of(renderer::pilot_rays, 1);
    const float low = model.requantise(rough, rough.plan).low_fraction;
    const float means = perceptual::share_of_mean(rough.plan.quantisation, {rough.plan.scale, rough.plan.intra});
    core::Plane<perceptual::PixelNoise> noise = seen;
    const auto loss_of = [&](double share) {
        const renderer::Allocation allocation{
            .typical = std::max(static_cast<float>(share) * low, perceptual::least_relative), .means = means};
        for (std::size_t i = 0; i < noise.size(); ++i) {
            const double allowed = allowed_square(share * std::sqrt(hidden.values()[i].alone));
            const auto [alone, of_block] = seen.values()[i];
            const double price = core::divide_or(allocation.priced(alone, of_block), static_cast<double>(alone), 1.0),
                         left = variance_of(worth(price * batches[i], allowed, allocation), batches[i]);
            const float times = core::divide_or(static_cast<float>(left), alone, 0.0f);
            noise.values()[i] = {times * alone, times * of_block};
        }
        const perceptual::NoisyPicture noisy{{rough.coefficients, rough.light.luma, {}},
                                             perceptual::noise_of_blocks(noise, rough.light.luma),
                                             rough.plan.quantisation,
                                             rough.plan.scale};
        return noisy.loss(1);
    };
    if (!(loss_of(most_share) > 0)) return share_of_none;
    return static_cast<float>(perceptual::number_of_loss(loss, least_share, most_share, loss_of));
}

LightLoss measure_loss(perceptual::CodedBlocks blocks, const perceptual::PixelLight& seen, const core::Radiance& light,
                       const perceptual::InverseLuma& display, const perceptual::CodingPlan& coding, double loss,
                       float share) {
    const perceptual::NoisyPicture noisy{
        std::move(blocks),
        perceptual::noise_of_blocks(perceptual::noise_of(seen, display, light.error, light.shared_error), seen.luma),
        coding.quantisation, coding.scale};
    constexpr double most_times = 8;
    if (!(noisy.loss(most_times) > 0)) return {0, share};
    const double wanted = std::pow(
        perceptual::number_of_loss(loss, 1 / most_times, most_times, [&](double times) { return noisy.loss(times); }),
        1 / error_power);
    const float change = std::clamp(static_cast<float>(wanted), 1 / most_change, most_change);
    return {noisy.loss(1), std::clamp(change * share, static_cast<float>(least_share), static_cast<float>(most_share))};
}

}  // namespace render2mpeg::app
