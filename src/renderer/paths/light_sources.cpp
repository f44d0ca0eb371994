#include "renderer/paths/light_sources.h"

namespace render2mpeg::renderer {

LightSources::LightSources(const PosedScene& posed_scene, const Plan& plan)
    : lamps_(plan.runs(Pass::punctual_lights) ? lamps_of(posed_scene) : Lights{}),
      surfaces_(plan.runs(Pass::emissive_lights) ? surfaces_of(posed_scene) : Lights{}),
      skies_(plan.runs(Pass::sky_light) ? skies_of(posed_scene) : Lights{}),
      surface_of_(posed_scene.animation().objects.size(), -1) {
    for (std::size_t i = 0; i < lamps_.lights().size(); ++i)
        if (lamps_.lights()[i]->extent().distant) suns_.push_back(i);
    for (std::size_t i = 0; i < surfaces_.lights().size(); ++i)
        surface_of_[surfaces_.lights()[i]->object()] = static_cast<int>(i);
}

float LightSources::surface_density(const LightQuery& query, const core::SurfaceAddress& address) const {
    const int index = surface_of_[address.object];
    return index < 0 ? 0.0f : surfaces_.density(static_cast<std::size_t>(index), query, {}, address);
}

}  // namespace render2mpeg::renderer
