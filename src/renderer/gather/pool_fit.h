#pragma once
// Fit of light among the points of a pool.
#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/gather/final_gather.h"
#include "renderer/gather/ray_sums.h"

namespace render2mpeg::renderer {

/// A plane of least squares through the light of a pool, by place on the surface and weighted by rays. What a point
/// itself found is drawn towards it by as much as noise explains what points are off it by: the empirical Bayes
/// estimator [Efron1973]. It keeps the pool's mean.
struct PoolFit {
    static constexpr std::size_t quantities = 3, least_points = 6;
    using Light = std::array<glm::dvec3, quantities>;

    std::vector<Light> plane;  ///< at the points; empty: of too few
    double own = 1;            ///< weight of what a point itself found
    double plane_share = 1;    ///< variance of the plane at a point, over a point's

    /// Variance that is left, over a point's.
    double variance_share() const { return plane_share + (1.0 - plane_share) * own; }
    /// The same as far as nothing but noise is off the plane.
    static double least_share(std::span<const GatherRequest> requests) {
        const bool is_exact = !(requests.front().tolerance.allows(1.0f) > 0.0f);
        return is_exact || requests.size() < least_points ? 1.0 : 3.0 / static_cast<double>(requests.size());
    }

    PoolFit(std::span<const GatherRequest> requests, std::span<const PointSums> sums);
};

/// Values at places of a surface of that normal, by the plane of least squares through what they are there.
std::vector<PoolFit::Light> plane_through(std::span<const glm::vec3> places, glm::vec3 normal,
                                          std::span<const double> weights, std::span<const PoolFit::Light> values);

}  // namespace render2mpeg::renderer
