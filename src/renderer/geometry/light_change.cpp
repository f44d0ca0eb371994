#include "renderer/geometry/light_change.h"

#include <algorithm>
#include <limits>
#include <span>

namespace render2mpeg::renderer {
namespace {

using Box = LightChange::Box;

/// Boxes are larger by such a part of themselves, so that rays graze none unnoticed.
constexpr float margin = 1e-3f;

void include(Box& box, glm::vec3 place) {
    box.low = glm::min(box.low, place);
    box.high = glm::max(box.high, place);
}

Box box_of(const scene::Snapshot& at, std::uint32_t object) {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    Box box{glm::vec3(infinite), glm::vec3(-infinite)};
    const scene::ObjectState& state = at.objects[object];
    if (!state.present) return box;
    const scene::Mesh& mesh = at.animation->meshes[static_cast<std::size_t>(at.animation->objects[object].mesh)];
    if (state.deformed >= 0)
        for (const glm::vec3& p : at.deformed[static_cast<std::size_t>(state.deformed)].positions) include(box, p);
    else
        for (const glm::vec3& p : mesh.positions) include(box, glm::vec3(state.to_world * glm::vec4(p, 1.0f)));
    const glm::vec3 wider = margin * (box.high - box.low);
    return {box.low - wider, box.high + wider};
}

float area(const Box& box) {
    const glm::vec3 size = box.high - box.low;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Of an object at both instants: one, unless that would be much larger than either.
void add_boxes(const scene::Snapshot& before, const scene::Snapshot& now, std::uint32_t object,
               std::vector<Box>& boxes) {
    if (!before.objects[object].present && !now.objects[object].present) return;
    const Box was = box_of(before, object), is = box_of(now, object);
    const Box both{glm::min(was.low, is.low), glm::max(was.high, is.high)};
    const bool one = !before.objects[object].present || !now.objects[object].present;
    // chosen: half more than the larger; not tuned.
    if (one || area(both) <= 1.5f * std::max(area(was), area(is))) {
        boxes.push_back(both);
        return;
    }
    boxes.push_back(was);
    boxes.push_back(is);
}

/// Joins boxes that lie next to each other until there are few.
void join(std::vector<Box>& boxes) {
    if (boxes.size() <= LightChange::most_boxes) return;
    Box all = boxes.front();
    for (const Box& box : boxes) include(all, box.low), include(all, box.high);
    const glm::vec3 size = all.high - all.low;
    const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    std::stable_sort(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) { return a.low[axis] < b.low[axis]; });
    std::vector<Box> joined(LightChange::most_boxes, {glm::vec3(0), glm::vec3(0)});
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const std::size_t k = i * LightChange::most_boxes / boxes.size();
        if (i == 0 || (i - 1) * LightChange::most_boxes / boxes.size() != k) joined[k] = boxes[i];
        include(joined[k], boxes[i].low), include(joined[k], boxes[i].high);
    }
    boxes.swap(joined);
}

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

bool same_but_strength(const scene::LightState& a, const scene::LightState& b) {
    return a.kind == b.kind && a.position == b.position && a.direction == b.direction && a.range == b.range &&
           a.cos_inner == b.cos_inner && a.cos_outer == b.cos_outer && a.angle == b.angle;
}

/// Whether a ray from `origin` passes a box within `far` of unit directions.
bool passes(const Box& box, glm::vec3 origin, glm::vec3 inverse, float far) {
    const glm::vec3 a = (box.low - origin) * inverse, b = (box.high - origin) * inverse;
    const glm::vec3 near3 = glm::min(a, b), far3 = glm::max(a, b);
    const float first = std::max(std::max(near3.x, near3.y), std::max(near3.z, 0.0f));
    const float last = std::min(std::min(far3.x, far3.y), std::min(far3.z, far));
    return first <= last;
}

/// Of a direction, without infinities.
glm::vec3 inverse_of(glm::vec3 direction) {
    glm::vec3 inverse;
    for (int k = 0; k < 3; ++k)
        inverse[k] = 1.0f / (std::abs(direction[k]) > 1e-12f ? direction[k] : std::copysign(1e-12f, direction[k]));
    return inverse;
}

}  // namespace

SeenChange::SeenChange(const LightChange& change, glm::vec3 origin) : change_(change), origin_(origin) {
    for (std::size_t i = 0; i < change.boxes.size(); ++i) {
        const Box& box = change.boxes[i];
        const glm::vec3 way = 0.5f * (box.low + box.high) - origin;
        const float radius2 = 0.25f * glm::dot(box.high - box.low, box.high - box.low), far2 = glm::dot(way, way);
        if (!(far2 > 1.001f * radius2)) continue;
        const float far = std::sqrt(far2);
        cones_[i] = {way / far, std::sqrt(1.0f - radius2 / far2) - 1e-4f, far - std::sqrt(radius2)};
    }
}

bool SeenChange::meets(const core::PackedNormal& direction, float far) const {
    for (std::size_t i = 0; i < change_.boxes.size(); ++i)
        if (far >= cones_[i].nearest && direction.faces(cones_[i].axis, cones_[i].cosine) &&
            passes(change_.boxes[i], origin_, inverse_of(direction.unpack()), far))
            return true;
    return false;
}

bool LightChange::holds(glm::vec3 place) const {
    return std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
        return glm::all(glm::greaterThanEqual(place, box.low)) && glm::all(glm::lessThanEqual(place, box.high));
    });
}

bool LightChange::none() const {
    const auto any = [](const std::vector<bool>& flags) {
        return std::find(flags.begin(), flags.end(), true) != flags.end();
    };
    return !all && !strengths && !any(objects) && !any(lamps);
}

bool LightChange::moves_sources(const scene::Animation& film) const {
    if (std::find(lamps.begin(), lamps.end(), true) != lamps.end()) return true;
    for (std::uint32_t o = 0; o < film.objects.size(); ++o)
        if (moves(o) && film.materials[static_cast<std::size_t>(film.objects[o].material)].emits()) return true;
    return false;
}

SourceStrengths strengths_of(const scene::Snapshot& snapshot) {
    SourceStrengths strengths;
    strengths.lamps.assign(snapshot.animation->lights.size(), glm::vec3(0));
    for (const scene::LightState& light : snapshot.lights) strengths.lamps[light.id] = light.intensity;
    for (std::size_t i = 0; i < snapshot.objects.size(); ++i)
        strengths.objects.push_back(
            snapshot.emission_factor[static_cast<std::size_t>(snapshot.animation->objects[i].material)]);
    return strengths;
}

LightChange change_between(const scene::Snapshot& before, const scene::Snapshot& now) {
    LightChange change;
    const std::size_t objects = now.objects.size();
    if (before.animation != now.animation || before.objects.size() != objects ||
        before.lights.size() != now.lights.size())
        return LightChange::everything();
    change.objects.assign(objects, false);
    for (std::uint32_t i = 0; i < objects; ++i) {
        if (same_object(before, now, i)) continue;
        change.objects[i] = true;
        add_boxes(before, now, i, change.boxes);
    }
    join(change.boxes);
    change.lamps.assign(now.animation->lights.size(), false);
    for (std::size_t i = 0; i < now.lights.size(); ++i) {
        if (before.lights[i].id != now.lights[i].id) return LightChange::everything();
        change.lamps[now.lights[i].id] = !same_but_strength(before.lights[i], now.lights[i]);
    }
    const SourceStrengths were = strengths_of(before), are = strengths_of(now);
    change.strengths = were.lamps != are.lamps || were.objects != are.objects;
    for (std::size_t i = 0; i < are.lamps.size(); ++i)
        for (int k = 0; k < 3; ++k) change.all = change.all || (are.lamps[i][k] > 0.0f && !(were.lamps[i][k] > 0.0f));
    for (std::size_t i = 0; i < are.objects.size(); ++i)
        change.all = change.all || (are.objects[i] > 0.0f && !(were.objects[i] > 0.0f));
    return change;
}

}  // namespace render2mpeg::renderer
