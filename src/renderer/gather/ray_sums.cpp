#include "renderer/gather/ray_sums.h"

#include "core/color.h"

namespace render2mpeg::renderer {

float batch_share(std::uint32_t rays) {
    static const auto of_few = [] {
        std::array<float, 1025> shares{};
        for (std::size_t n = 1; n < shares.size(); ++n)
            shares[n] = std::pow(batch_rays / static_cast<float>(n), variance_power);
        return shares;
    }();
    return rays < of_few.size() ? of_few[rays] : std::pow(batch_rays / static_cast<float>(rays), variance_power);
}

double shown_luminance(const GatherPoint& point, const std::array<glm::vec3, 3>& light) {
    const Bsdf& bsdf = point.point.bsdf;
    return core::luminance(point.weight * (bsdf.diffuse * light[0] + bsdf.f0 * light[1] + bsdf.f90 * light[2]));
}

}  // namespace render2mpeg::renderer
