#pragma once
// How many samples an estimate gets: one law for edges, exposures, lamps, rays, records, hair and photons.
#include <cmath>
#include <cstdint>

namespace render2mpeg::renderer {

/// Standard error of the mean of n stratified samples, over that of one sample: only the strata that an edge crosses
/// err, about sqrt(n) of n. Its variance falls with n to this power.
inline constexpr double strata_power = 1.5;
inline float strata_error(float n) {
    return 1.0f / (std::sqrt(n) * std::sqrt(std::sqrt(n)));
}

/// Samples whose mean has the variance `allowed`, where that of `samples` has `variance` and it falls with their number
/// to `power`. Infinite where nothing is allowed.
inline double samples_for(double allowed, double samples, double variance, double power = 1) {
    return allowed > 0.0 ? samples * std::pow(variance / allowed, 1.0 / power) : HUGE_VAL;
}

/// Power of the number of rays that their mean's variance falls with. chosen: 1.2, of 1.14 to 1.32 measured in Sponza
/// and a box; independent rays have 1, a smooth integrand more than 2.
inline constexpr float variance_power = 1.2f;

/// Rays of a point's pilot, its first: two batches of 8.
inline constexpr std::uint32_t pilot_rays = 16;

/// Worth of samples in a picture: those that a tolerance asks for, at the price of all others
/// (docs/model/gathering.md#how-many-rays).
struct Allocation {
    float typical = 0;  ///< ToleranceMap::typical; 0: tolerances are bounds, whatever they cost
    float means = 1;    ///< ToleranceMap::means
    float most = 0;     ///< ToleranceMap::most_rays

    /// N of N_T rays, which would meet the tolerance (docs/model/gathering.md, eq. 3), at most `most`; or of samples
    /// that cost as many rays each.
    double worth(double rays, double cost = 1) const;
    double capped(double rays) const { return most > 0.0f && rays > 1.0 * most ? 1.0 * most : rays; }
    /// Mean square error that these leave, over the square of the tolerance's standard error.
    double left(double rays) const;
    /// A pixel's mean square error, with what of it the mean of its block has at the price of that.
    double priced(double square, double of_block) const { return square + (1.0 / (means * means) - 1.0) * of_block; }
};

}  // namespace render2mpeg::renderer
