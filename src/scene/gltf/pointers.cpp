// Where channels of KHR_animation_pointer point.
#include <array>
#include <charconv>
#include <string_view>

#include "scene/gltf/parts.h"

namespace render2mpeg::scene::gltf {
namespace {

using enum TrackTarget;

struct Place {
    std::string_view before, after, kind;  ///< text around the index, and the indexed array
    TrackTarget what;
    bool strength = false;  ///< as in PointedTrack
};

constexpr std::array<Place, 11> places{{
    {"/nodes/", "/translation", "nodes", translation},
    {"/nodes/", "/rotation", "nodes", rotation},
    {"/nodes/", "/scale", "nodes", scale},
    {"/nodes/", "/weights", "nodes", weights},
    {"/nodes/", "/extensions/KHR_node_visibility/visible", "nodes", visibility},
    {"/cameras/", "/perspective/yfov", "cameras", field_of_view},
    {"/extensions/KHR_lights_punctual/lights/", "/intensity", "", light_intensity},
    {"/extensions/KHR_lights_punctual/lights/", "/color", "", light_color},
    {"/materials/", "/pbrMetallicRoughness/baseColorFactor", "materials", base_color},
    {"/materials/", "/emissiveFactor", "materials", emission},
    {"/materials/", "/extensions/KHR_materials_emissive_strength/emissiveStrength", "materials", emission, true},
}};

std::size_t count_of(const Document& document, const Place& place) {
    if (!place.kind.empty()) return document.count(place.kind.data());
    const std::optional<Element> lights = document.root().extension("KHR_lights_punctual");
    return lights ? lights->objects("lights").size() : 0;
}

}  // namespace

PointedTrack pointed_track(const Document& document, const std::string& pointer) {
    for (const Place& place : places) {
        if (!std::string_view(pointer).starts_with(place.before) || !std::string_view(pointer).ends_with(place.after))
            continue;
        const char* first = pointer.data() + place.before.size();
        const char* last = pointer.data() + pointer.size() - place.after.size();
        int index = -1;
        if (first >= last) continue;
        const auto [end, failure] = std::from_chars(first, last, index);
        if (failure != std::errc() || end != last || index < 0) continue;
        if (static_cast<std::size_t>(index) >= count_of(document, place)) continue;
        return {place.what, index, place.strength};
    }
    return {};
}

std::vector<PointedTrack> pointed_tracks(const Document& document) {
    std::vector<PointedTrack> tracks;
    for (const Element& animation : document.all("animations"))
        for (const Element& channel : animation.objects("channels"))
            if (const auto target = channel.object("target"))
                if (const auto extension = target->extension("KHR_animation_pointer"))
                    tracks.push_back(pointed_track(document, extension->string("pointer", "")));
    return tracks;
}

}  // namespace render2mpeg::scene::gltf
