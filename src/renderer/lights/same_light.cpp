#include "renderer/lights/same_light.h"

#include <algorithm>

namespace render2mpeg::renderer {

Sight sight_of(const scene::Snapshot& snapshot, std::int64_t lit_frame, const core::ToleranceMap& tolerance) {
    const scene::Camera& camera = snapshot.camera;
    return {camera.to_world(), camera.lens().vertical_fov, camera.lens().y_magnification, lit_frame, tolerance.pixels};
}

bool same_light(const scene::Snapshot& a, const scene::Snapshot& b) {
    const auto same_object = [](const scene::ObjectState& x, const scene::ObjectState& y) {
        return x.to_world == y.to_world && x.present == y.present && x.deformed == y.deformed;
    };
    const auto same_lamp = [](const scene::LightState& x, const scene::LightState& y) {
        return x.kind == y.kind && x.position == y.position && x.direction == y.direction &&
               x.intensity == y.intensity && x.range == y.range && x.cos_inner == y.cos_inner &&
               x.cos_outer == y.cos_outer && x.angle == y.angle && x.id == y.id;
    };
    const auto same_shape = [](const scene::DeformedMesh& x, const scene::DeformedMesh& y) {
        return x.positions == y.positions && x.normals == y.normals;
    };
    return std::equal(a.objects.begin(), a.objects.end(), b.objects.begin(), b.objects.end(), same_object) &&
           std::equal(a.lights.begin(), a.lights.end(), b.lights.begin(), b.lights.end(), same_lamp) &&
           std::equal(a.deformed.begin(), a.deformed.end(), b.deformed.begin(), b.deformed.end(), same_shape) &&
           a.emission_factor == b.emission_factor && a.base_color == b.base_color;
}

}  // namespace render2mpeg::renderer
