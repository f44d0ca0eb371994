#pragma once
// Sums of a point's gather rays so far.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "core/numeric.h"
#include "renderer/base/allocation.h"
#include "renderer/surface/gather_point.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {

/// Rays of one batch whose spread is looked at.
inline constexpr std::uint32_t batch_rays = 8;

/// Variance of the mean of so many rays over that of a batch; 0 of none.
double batch_share(std::uint32_t rays);

/// Luminance that the pixel shows of light found by rays: irradiance over pi and the lobe's two parts.
double shown_luminance(const GatherPoint& point, const std::array<glm::vec3, 3>& light);

/// Sums over some rays of a point.
struct RaySums {
    std::array<glm::dvec3, 3> light{};  ///< irradiance over pi, and the lobe's two parts: RayLight
    std::array<double, 3> weight{};
    double nearness = 0;  ///< weighted as the lobe's light
    std::uint32_t rays = 0;

    double mean_nearness() const { return core::divide_or(nearness, weight[1] + weight[2], 0.0); }

    /// Light by all of them. Weights of rays along a narrow lobe come to its albedo in the end [Karis2013].
    std::array<glm::vec3, 3> mean(const std::optional<LobeAlbedo>& albedo) const {
        const double share = 1.0 / rays, of_f0 = albedo ? core::divide_or(1.0 * albedo->f0, weight[1], 0.0) : share,
                     of_f90 = albedo ? core::divide_or(1.0 * albedo->f90, weight[2], 0.0) : share;
        return {glm::vec3(share * light[0]), glm::vec3(of_f0 * light[1]), glm::vec3(of_f90 * light[2])};
    }
};

/// Sums of a point's rays so far.
struct PointSums : RaySums {
    std::optional<LobeAlbedo> albedo{};     ///< of a narrow lobe
    double batches = 0, batch_squares = 0;  ///< of luminances of the pixel, means of batches
    std::uint32_t pool = 0;
    std::array<double, 2> first_batches{};  ///< likewise, of the first two

    std::array<glm::vec3, 3> mean() const { return RaySums::mean(albedo); }
    void forget() {
        static_cast<RaySums&>(*this) = {};
        batches = batch_squares = 0;
    }
    /// Variance of the mean of a batch.
    double batch_variance() const {
        const double n = rays / batch_rays;
        return n < 2 ? 0.0 : std::max(batch_squares - batches * batches / n, 0.0) / (n - 1);
    }
    /// Variance of the mean of all rays.
    double variance() const { return batch_variance() * batch_share(rays); }
};

}  // namespace render2mpeg::renderer
