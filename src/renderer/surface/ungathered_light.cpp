#include "renderer/surface/ungathered_light.h"

#include <utility>

namespace render2mpeg::renderer {

void UngatheredLight::add(const EffectLight& light) {
    for (std::size_t p = 0; p < light.all.size(); ++p) all_.values()[p] += light.all.values()[p];
    if (specular_.empty()) return;
    for (std::size_t p = 0; p < light.specular.size(); ++p) specular_.values()[p] += light.specular.values()[p];
}

void UngatheredLight::add_caustics(EffectLight light, std::vector<PointCaustic> of_points) {
    caustics_of_points_ = std::move(of_points);
    add(caustics_ = std::move(light));
}

}  // namespace render2mpeg::renderer
