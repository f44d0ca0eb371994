// Checks tracks.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/text.h"
#include "scene/model/wording.h"
#include "scene/pose/pose.h"
#include "scene/preparation/validate.h"

namespace render2mpeg::scene {
namespace {

enum class Moves { nodes, lights, materials, cameras, reflections };

/// Facts about a track target, with the kind of thing that its tracks move.
struct TargetFacts {
    TrackTarget target;
    const char* word;  ///< for messages
    int width;         ///< values of a key; 0: as many as there are morph targets
    Moves moves;
};

const TargetFacts& facts_of(TrackTarget target) {
    using enum TrackTarget;
    static constexpr TargetFacts all[] = {{translation, "translation", 3, Moves::nodes},
                                          {rotation, "rotation", 4, Moves::nodes},
                                          {scale, "scale", 3, Moves::nodes},
                                          {weights, "morph weights", 0, Moves::nodes},
                                          {visibility, "visibility", 1, Moves::nodes},
                                          {light_intensity, "intensity", 1, Moves::lights},
                                          {light_color, "colour", 3, Moves::lights},
                                          {emission, "emission", 1, Moves::materials},
                                          {base_color, "base colour", 4, Moves::materials},
                                          {field_of_view, "field of view", 1, Moves::cameras},
                                          {f_stop, "f-stop", 1, Moves::cameras},
                                          {focus_distance, "focus distance", 1, Moves::cameras},
                                          {reflection_radius, "radius", 1, Moves::reflections},
                                          {reflection_border, "border", 1, Moves::reflections}};
    return *std::find_if(std::begin(all), std::end(all), [&](const TargetFacts& f) { return f.target == target; });
}

/// Name of a track's target, which must exist.
std::string target_of(const Animation& animation, const Track& track) {
    const std::size_t i = static_cast<std::size_t>(track.index);
    const TargetFacts& facts = facts_of(track.target);
    const std::string word = facts.word;
    const auto named = [&](const char* kind, const auto& things) {
        if (track.index < 0 || i >= things.size())
            refuse(animation, "track of " + word,
                   std::string("moves ") + kind + " " + std::to_string(track.index) + ", which is not there");
        return "track of " + word + " of " + described(kind, i, things[i].name);
    };
    if (facts.moves == Moves::reflections && i < animation.reflections.size())
        return "track of " + word + " of reflection " + std::to_string(i);
    if (facts.moves == Moves::lights) return named("light", animation.lights);
    if (facts.moves == Moves::materials) return named("material", animation.materials);
    return facts.moves == Moves::cameras ? named("camera", animation.cameras) : named("node", animation.nodes);
}

std::size_t values_per_key(const Track& track) {
    return static_cast<std::size_t>(track.width) * (track.interpolation == Interpolation::cubic_spline ? 3u : 1u);
}

/// Of keys at the same time keeps the last; throws for times that fall.
void order_keys(const Animation& animation, const std::string& name, Track& track) {
    const std::size_t per_key = values_per_key(track);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < track.times.size(); ++k) {
        if (k > 0 && track.times[k] < track.times[k - 1])
            refuse(animation, name, "the time of key " + std::to_string(k) + " is before that of the key before it");
        if (kept > 0 && track.times[k] == track.times[kept - 1]) --kept;
        track.times[kept] = track.times[k];
        std::copy_n(track.values.begin() + static_cast<std::ptrdiff_t>(k * per_key), per_key,
                    track.values.begin() + static_cast<std::ptrdiff_t>(kept * per_key));
        ++kept;
    }
    track.times.resize(kept);
    track.values.resize(kept * per_key);
}

/// Rotations of length 0 become identities, with a note.
void mend_rotations(Animation& animation, const std::string& name, Track& track) {
    if (track.target != TrackTarget::rotation) return;
    const std::size_t per_key = values_per_key(track);
    const std::size_t offset = track.interpolation == Interpolation::cubic_spline ? 4 : 0;
    for (std::size_t k = 0; k < track.times.size(); ++k) {
        float* q = track.values.data() + k * per_key + offset;
        if (q[0] != 0 || q[1] != 0 || q[2] != 0 || q[3] != 0) continue;
        q[3] = 1;
        note_once(animation, name + ": key " + std::to_string(k) + " is zero; taken as no rotation");
    }
}

/// Refuses impossible angles and factors.
void check_values(const Animation& animation, const std::string& name, const Track& track) {
    if (track.target == TrackTarget::field_of_view) {
        // A spline may overshoot between keys; frames are clamped.
        for (std::size_t v = track.interpolation == Interpolation::cubic_spline ? 1 : 0; v < track.values.size();
             v += track.interpolation == Interpolation::cubic_spline ? 3 : 1)
            if (!(track.values[v] > 0 && track.values[v] < 3.1415f))
                refuse(animation, name, "a field of view must lie between 0 and pi");
    }
    if (track.target != TrackTarget::weights) return;
    for (const Object& object : animation.objects) {
        if (object.node != track.index || object.mesh < 0 ||
            static_cast<std::size_t>(object.mesh) >= animation.meshes.size())
            continue;
        const std::size_t targets = animation.meshes[static_cast<std::size_t>(object.mesh)].morph_targets.size();
        if (targets != 0 && targets != static_cast<std::size_t>(track.width))
            refuse(animation, name,
                   "has " + core::counted(static_cast<std::size_t>(track.width), "weight") + " for " +
                       core::counted(targets, "morph target"));
    }
}

}  // namespace

void validate_tracks(Animation& animation) {
    for (Track& track : animation.tracks) {
        const std::string name = target_of(animation, track);
        const int width = facts_of(track.target).width;
        if (track.width < 1 || (width > 0 && track.width != width))
            refuse(animation, name, "has a wrong number of values per key");
        if (track.times.empty()) refuse(animation, name, "has no keys");
        if (track.values.size() != track.times.size() * values_per_key(track))
            refuse(animation, name,
                   "has " + core::counted(track.values.size(), "value") + " where its keys ask for " +
                       std::to_string(track.times.size() * values_per_key(track)));
        for (std::size_t k = 0; k < track.times.size(); ++k)
            if (!std::isfinite(track.times[k]))
                refuse(animation, name, "the time of key " + std::to_string(k) + " is not finite");
        for (std::size_t v = 0; v < track.values.size(); ++v)
            if (!std::isfinite(track.values[v]))
                refuse(animation, name, "key " + std::to_string(v / values_per_key(track)) + " is not finite");
        const bool moves_node = track.target == TrackTarget::translation || track.target == TrackTarget::rotation ||
                                track.target == TrackTarget::scale;
        if (moves_node && animation.nodes[static_cast<std::size_t>(track.index)].matrix)
            refuse(animation, name, "the node has a matrix; only translation, rotation and scale can be animated");
        order_keys(animation, name, track);
        mend_rotations(animation, name, track);
        check_values(animation, name, track);
    }
}

bool varies(const Track& track) {
    const std::size_t per_key = values_per_key(track);
    const std::size_t n = static_cast<std::size_t>(track.width);
    const bool cubic = track.interpolation == Interpolation::cubic_spline;
    const std::size_t offset = cubic ? n : 0;
    for (std::size_t k = 0; k < track.times.size(); ++k) {
        const float* key = track.values.data() + k * per_key;
        if (!std::equal(key + offset, key + offset + n, track.values.data() + offset)) return true;
        if (!cubic || track.times.size() == 1) continue;
        // Equal values with tangents still bend the curve between them.
        const auto is_zero = [](float v) { return v == 0; };
        const bool first = k == 0, last = k + 1 == track.times.size();
        if (!first && !std::all_of(key, key + n, is_zero)) return true;
        if (!last && !std::all_of(key + 2 * n, key + 3 * n, is_zero)) return true;
    }
    return false;
}

std::vector<char> moving_nodes(const Animation& animation) {
    std::vector<char> moves(animation.nodes.size(), 0);
    for (const Track& track : animation.tracks) {
        const bool is_place = track.target == TrackTarget::translation || track.target == TrackTarget::rotation ||
                              track.target == TrackTarget::scale || track.target == TrackTarget::visibility;
        if (is_place && varies(track)) moves[static_cast<std::size_t>(track.index)] = 1;
    }
    for (const int n : parents_first(animation.nodes)) {
        const int parent = animation.nodes[static_cast<std::size_t>(n)].parent;
        if (parent >= 0 && moves[static_cast<std::size_t>(parent)]) moves[static_cast<std::size_t>(n)] = 1;
    }
    return moves;
}

}  // namespace render2mpeg::scene
