#include "renderer/base/allocation.h"

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Rays after which one more buys its price where N rays meet the tolerance: N0 of docs/model/gathering.md, times the
/// typical tolerance. chosen: 10, of 4 to 20 on cornell, colonnade and character, for most squared error a ray.
constexpr double worth_rays = 10.0;

}  // namespace

double Allocation::worth(double rays, double cost) const {
    constexpr double gain = variance_power / (1.0 + variance_power);
    return capped(typical > 0.0f ? std::pow(rays, gain) * std::pow(worth_rays / (typical * cost), 1.0 - gain) : rays);
}

double Allocation::left(double rays) const {
    return std::pow(core::divide_or(rays, worth(rays), 1.0), variance_power);
}

}  // namespace render2mpeg::renderer
