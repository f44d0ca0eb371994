#include "renderer/lights/light.h"

namespace render2mpeg::renderer {

Lights lamps_of(const scene::Snapshot& instant) {
    Lights lamps;
    for (const scene::LightState& lamp : instant.lights)
        if (point_of_lamp(lamp).shines()) lamps.push_back(lamp.is_distant() ? sun_light(lamp) : punctual_light(lamp));
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
