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

PoolFit::PoolFit(std::span<const GatherRequest> requests, std::span<const PointSums> sums) {
    const std::size_t n = requests.size();
    plane_share = least_share(requests);
    if (plane_share == 1.0) return;
    const SurfacePoint& first = requests.front().point->point;
    glm::vec3 t, b;
    core::make_frame(first.shading_normal, t, b);
    std::vector<glm::dvec2> place(n);
    double rays = 0;
    glm::dvec2 middle(0);
    for (std::size_t i = 0; i < n; ++i) {
        const glm::vec3 d = requests[i].point->point.position - first.position;
        place[i] = {glm::dot(t, d), glm::dot(b, d)};
        middle += 1.0 * sums[i].rays * place[i];
        rays += sums[i].rays;
    }
    middle /= rays;
    Light mean{}, x{}, y{};
    double xx = 0, xy = 0, yy = 0;
    for (std::size_t i = 0; i < n; ++i) {
        place[i] -= middle;
        xx += sums[i].rays * place[i].x * place[i].x;
        xy += sums[i].rays * place[i].x * place[i].y;
        yy += sums[i].rays * place[i].y * place[i].y;
        const std::array<glm::vec3, quantities> found = sums[i].mean();
        for (std::size_t k = 0; k < quantities; ++k) {
            const glm::dvec3 sum = 1.0 * sums[i].rays * glm::dvec3(found[k]);
            mean[k] += sum / rays;
            x[k] += place[i].x * sum;
            y[k] += place[i].y * sum;
        }
    }
    // Points in a row say nothing about the other direction.
    const double ridge = 1e-3 * (xx + yy);
    xx += ridge, yy += ridge;
    const double over = core::divide_or(1.0, xx * yy - xy * xy, 0.0);
    plane.resize(n);
    double off = 0, noise = 0;
    for (std::size_t i = 0; i < n; ++i) {
        std::array<glm::vec3, quantities> difference = sums[i].mean();
        for (std::size_t k = 0; k < quantities; ++k) {
            plane[i][k] =
                mean[k] + over * ((yy * x[k] - xy * y[k]) * place[i].x + (xx * y[k] - xy * x[k]) * place[i].y);
            difference[k] -= glm::vec3(plane[i][k]);
        }
        const double d = shown_luminance(*requests[i].point, difference);
        off += d * d;
        noise += sums[i].variance();
    }
    off /= static_cast<double>(n) - 3.0;
    noise /= static_cast<double>(n);
    own = off > noise ? 1.0 - noise / off : 0.0;
    // What is infinite stays at its point.
    if (!(off + noise < std::numeric_limits<double>::infinity())) plane.clear(), own = plane_share = 1;
}

}  // namespace render2mpeg::renderer
