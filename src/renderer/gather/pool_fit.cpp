#include "renderer/gather/pool_fit.h"

#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"

namespace render2mpeg::renderer {

double shown_luminance(const GatherPoint& point, const std::array<glm::vec3, 3>& light) {
    const Bsdf& bsdf = point.point.bsdf;
    return core::luminance(point.weight * (bsdf.diffuse * light[0] + bsdf.f0 * light[1] + bsdf.f90 * light[2]));
}

std::vector<PoolFit::Light> plane_through(std::span<const glm::vec3> places, glm::vec3 normal,
                                          std::span<const double> weights, std::span<const PoolFit::Light> values) {
    const std::size_t n = places.size();
    glm::vec3 t, b;
    core::make_frame(normal, t, b);
    std::vector<glm::dvec2> place(n);
    double all = 0;
    glm::dvec2 middle(0);
    for (std::size_t i = 0; i < n; ++i) {
        const glm::vec3 d = places[i] - places.front();
        place[i] = {glm::dot(t, d), glm::dot(b, d)};
        middle += weights[i] * place[i];
        all += weights[i];
    }
    middle /= all;
    PoolFit::Light mean{}, x{}, y{};
    double xx = 0, xy = 0, yy = 0;
    for (std::size_t i = 0; i < n; ++i) {
        place[i] -= middle;
        xx += weights[i] * place[i].x * place[i].x;
        xy += weights[i] * place[i].x * place[i].y;
        yy += weights[i] * place[i].y * place[i].y;
        for (std::size_t k = 0; k < mean.size(); ++k) {
            const glm::dvec3 sum = weights[i] * values[i][k];
            mean[k] += sum / all;
            x[k] += place[i].x * sum;
            y[k] += place[i].y * sum;
        }
    }
    // Points in a row say nothing about the other direction.
    const double ridge = 1e-3 * (xx + yy);
    xx += ridge, yy += ridge;
    const double over = core::divide_or(1.0, xx * yy - xy * xy, 0.0);
    std::vector<PoolFit::Light> plane(n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < mean.size(); ++k)
            plane[i][k] =
                mean[k] + over * ((yy * x[k] - xy * y[k]) * place[i].x + (xx * y[k] - xy * x[k]) * place[i].y);
    return plane;
}

PoolFit::PoolFit(std::span<const GatherRequest> requests, std::span<const PointSums> sums) {
    const std::size_t n = requests.size();
    plane_share = least_share(requests);
    if (plane_share == 1.0) return;
    std::vector<glm::vec3> places;
    std::vector<double> weights;
    std::vector<Light> found;
    for (std::size_t i = 0; i < n; ++i) {
        const std::array<glm::vec3, quantities> mean = sums[i].mean();
        places.push_back(requests[i].point->point.position);
        weights.push_back(sums[i].rays);
        found.push_back({mean[0], mean[1], mean[2]});
    }
    plane = plane_through(places, requests.front().point->point.shading_normal, weights, found);
    double off = 0, noise = 0;
    for (std::size_t i = 0; i < n; ++i) {
        std::array<glm::vec3, quantities> difference;
        for (std::size_t k = 0; k < quantities; ++k) difference[k] = glm::vec3(found[i][k]) - glm::vec3(plane[i][k]);
        const double d = shown_luminance(*requests[i].point, difference);
        off += d * d;
        noise += sums[i].variance();
    }
    off /= static_cast<double>(n) - 3.0;
    noise /= static_cast<double>(n);
    own = off > noise ? 1.0 - noise / off : 0.0;
    // Infinite light stays at its point.
    if (!(off + noise < std::numeric_limits<double>::infinity())) plane.clear(), own = plane_share = 1;
}

}  // namespace render2mpeg::renderer
