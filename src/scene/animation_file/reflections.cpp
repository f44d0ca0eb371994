#include "scene/animation_file/reflections.h"

#include "core/box.h"
#include "core/text.h"
#include "scene/animation_file/keys.h"

namespace render2mpeg::scene {
namespace {

namespace keys = animation_file_keys;

/// All lists of a thing's edits: its own first, then those of its keys.
std::vector<JsonValue> lists_of(const JsonValue& thing) {
    std::vector<JsonValue> lists;
    if (const auto own = thing.find("reflections")) lists.push_back(*own);
    const auto moments = thing.find("keys");
    for (const JsonValue& key : moments ? moments->list(1, most_keys) : std::vector<JsonValue>{})
        if (const auto list = key.find("reflections")) lists.push_back(*list);
    return lists;
}

/// A node that a curve moves.
int node_of(const Curve& curve, const std::string& name, int parent, Animation& film) {
    const int node = add_node(film, name, parent);
    film.nodes.back().translation = {curve.values[0], curve.values[1], curve.values[2]};
    if (curve.times.size() > 1) film.tracks.push_back(track_of(curve, TrackTarget::translation, node));
    return node;
}

/// A node in the middle of a named object, which goes along with it.
int node_of(const JsonValue& see, Animation& film) {
    const std::string name = see.text();
    std::vector<std::string_view> names;
    core::Box box;
    int parent = -1;
    for (const Object& object : film.objects) {
        names.emplace_back(object.name);
        if (object.name != name || (parent >= 0 && object.node != parent)) continue;
        if (object.skin >= 0)
            see.fail("joints move \"" + name + "\"; say a point, or the name of something at a joint");
        parent = object.node;
        for (const glm::vec3& p : film.meshes[static_cast<std::size_t>(object.mesh)].positions) box.hold(p);
    }
    if (parent < 0) see.fail("there is no object \"" + name + "\"" + core::did_you_mean(name, names, "\"", "\""));
    const int node = add_node(film, name + " (seen)", parent);
    if (box.any()) film.nodes.back().translation = glm::dvec3(box.middle());
    return node;
}

}  // namespace

bool has_reflections(const JsonValue& thing) {
    return !lists_of(thing).empty();
}

void read_reflections(const JsonValue& thing, int node, Animation& film, const FilmClock& clock) {
    std::vector<JsonValue> entries;  // by number, as they are first said
    for (const JsonValue& list : lists_of(thing)) {
        const std::vector<JsonValue> here = list.list(0, most_reflections);
        for (const JsonValue& entry : here) entry.allow_only(keys::reflection);
        for (std::size_t k = entries.size(); k < here.size(); ++k) entries.push_back(here[k]);
    }
    for (std::size_t k = 0; k < entries.size(); ++k) {
        const auto curve = [&](std::string_view name, int width, double least, double most) {
            Quantity quantity{name, width, least, most, true};
            quantity.reflection = static_cast<int>(k);
            return curve_of(thing, quantity, clock, keys::object_key);
        };
        const auto lacks = [&](const Curve& c, const std::string& name) {
            if (c.empty()) entries[k].fail("lacks \"" + name + "\"");
        };
        const std::string name = film.nodes[static_cast<std::size_t>(node)].name;
        const Curve at = curve("at", 3, -1e7, 1e7), radius = curve("radius", 1, smallest_size, largest_size),
                    border = curve("border", 1, smallest_size, largest_size);
        lacks(at, "at");
        lacks(radius, "radius");
        const std::size_t number = film.reflections.size();
        Reflection edit;
        edit.mirror = node;
        edit.at = node_of(at, name + " (point)", node, film);
        const auto see = entries[k].find("see");
        if (see && see->is_text()) {
            edit.see = node_of(*see, film);
        } else {
            const Curve place = curve("see", 3, -1e7, 1e7);
            lacks(place, "see");
            edit.see = node_of(place, name + " (seen)", -1, film);
        }
        const auto set = [&](const Curve& c, TrackTarget target, float& into) {
            into = static_cast<float>(c.values[0]);
            if (c.times.size() > 1) film.tracks.push_back(track_of(c, target, static_cast<int>(number)));
        };
        set(radius, TrackTarget::reflection_radius, edit.radius);
        set(border.empty() ? radius : border, TrackTarget::reflection_border, edit.border);
        film.reflections.push_back(edit);
    }
}

}  // namespace render2mpeg::scene
