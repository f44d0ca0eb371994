#include "renderer/lights/light.h"

namespace render2mpeg::renderer {

Lights lamps_of(const scene::Snapshot& instant) {
    Lights lamps;
    for (const scene::LightState& lamp : instant.lights)
        if (point_of_lamp(lamp).shines()) lamps.push_back(lamp.is_distant() ? sun_light(lamp) : punctual_light(lamp));
    return lamps;
}

Lights lamps_of(const PosedScene& posed_scene) {
    Lights lamps = lamps_of(posed_scene.posed());
    if (posed_scene.air() == nullptr) return lamps;
    std::uint32_t id = first_flame_id;
    for (const VolumeMedium& volume : posed_scene.air()->volumes()) {
        for (std::uint32_t k = 0; k < volume.field().flames().size(); ++k) {
            const Flame& flame = volume.field().flames()[k];
            LightPoint point;
            point.type = LightType::punctual;
            point.position = volume.to_world(flame.place);
            point.intensity = glm::min(volume.intensity(flame), glm::vec3(1e30f));
            point.disc2 = flame.radius * flame.radius * volume.voxel() * volume.voxel();
            point.id = id + k;
            if (point.shines()) lamps.push_back(flame_light(point));
        }
        id += VolumeField::most_flames;
    }
    return lamps;
}

LightPoint point_of_lamp(const scene::LightState& lamp) {
    LightPoint point;
    point.position = lamp.position;
    point.normal = lamp.direction;
    point.intensity = lamp.intensity;
    point.range = lamp.range;
    point.id = first_lamp_id + lamp.id;
    return point;
}

}  // namespace render2mpeg::renderer
