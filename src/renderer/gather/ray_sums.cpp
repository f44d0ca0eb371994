#include "renderer/gather/ray_sums.h"

#include "core/color.h"

namespace render2mpeg::renderer {

double batch_share(std::uint32_t rays) {
    const auto share = [](std::uint32_t n) { return std::pow(1.0 * batch_rays / n, variance_power); };
    static const auto of_few = [&] {
        std::array<double, 1025> shares{};
        for (std::uint32_t n = 1; n < shares.size(); ++n) shares[n] = share(n);
        return shares;
    }();
    return rays < of_few.size() ? of_few[rays] : share(rays);
}

double shown_luminance(const GatherPoint& point, const std::array<glm::vec3, 3>& light) {
    const Bsdf& bsdf = point.point.bsdf;
    return core::luminance(point.weight * (bsdf.diffuse * light[0] + bsdf.f0 * light[1] + bsdf.f90 * light[2]));
}

}  // namespace render2mpeg::renderer
