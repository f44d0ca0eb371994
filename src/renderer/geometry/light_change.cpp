#include "renderer/geometry/light_change.h"

namespace render2mpeg::renderer {
namespace {

bool same_object(const scene::Snapshot& a, const scene::Snapshot& b, std::size_t i) {
    const scene::ObjectState &x = a.objects[i], &y = b.objects[i];
    const auto material = static_cast<std::size_t>(a.animation->objects[i].material);
    if (x.present != y.present || x.to_world != y.to_world || x.deformed != y.deformed ||
        a.base_color[material] != b.base_color[material])
        return false;
    if (x.deformed < 0) return true;
    const scene::DeformedMesh &s = a.deformed[static_cast<std::size_t>(x.deformed)],
                              &t = b.deformed[static_cast<std::size_t>(y.deformed)];
    return s.positions == t.positions && s.normals == t.normals;
}

}  // namespace

LightChange change_between(const scene::Snapshot& before, const scene::Snapshot& now) {
    if (before.animation != now.animation || before.objects.size() != now.objects.size()) return {true, true};
    LightChange change;
    change.sources = before.lights != now.lights || before.emission_factor != now.emission_factor;
    if (before.volumes != now.volumes) change = {true, true};
    for (std::size_t i = 0; i < now.objects.size(); ++i) {
        if (same_object(before, now, i)) continue;
        change.things = true;
        const auto material = static_cast<std::size_t>(now.animation->objects[i].material);
        change.sources = change.sources || now.animation->materials[material].emits();
    }
    return change;
}

}  // namespace render2mpeg::renderer
