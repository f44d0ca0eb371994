// Completes a loaded film: checks, repairs, default light and camera.
#include "scene/preparation/complete.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/rational.h"
#include "core/text.h"
#include "scene/model/wording.h"
#include "scene/pose/extent.h"
#include "scene/pose/pose.h"
#include "scene/preparation/bodies.h"
#include "scene/preparation/default_light.h"
#include "scene/preparation/framing.h"
#include "scene/preparation/lost_objects.h"
#include "scene/preparation/traits.h"
#include "scene/preparation/validate.h"

namespace render2mpeg::scene {
namespace {

/// Whether all times are whole frames of a rate, as far as single precision tells.
bool are_frames(const std::vector<float>& times, double rate) {
    return std::all_of(times.begin(), times.end(), [rate](float time) {
        const double frame = static_cast<double>(time) * rate;
        return std::abs(frame - std::round(frame)) < 2e-3 + 4e-7 * frame;
    });
}

void set_mobility(Animation& animation) {
    const std::vector<char> moves = moving_nodes(animation);
    std::vector<char> morphs(animation.nodes.size(), 0);
    for (const Track& track : animation.tracks)
        if (track.target == TrackTarget::weights) morphs[static_cast<std::size_t>(track.index)] = 1;
    std::vector<char> recoloured(animation.materials.size(), 0);
    for (const Track& track : animation.tracks)
        if (track.target == TrackTarget::base_color && varies(track))
            recoloured[static_cast<std::size_t>(track.index)] = 1;

    for (Object& object : animation.objects) {
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        const bool has_weights =
            std::any_of(object.morph_weights.begin(), object.morph_weights.end(), [](float w) { return w != 0; });
        const bool is_morphed = !mesh.morph_targets.empty() &&
                                (has_weights || (object.node >= 0 && morphs[static_cast<std::size_t>(object.node)]));
        if (object.skin >= 0 || is_morphed)
            object.mobility = Mobility::deforming;
        else
            // An object of changing colour reflects changing light, like a moving one.
            object.mobility = (object.node >= 0 && moves[static_cast<std::size_t>(object.node)]) ||
                                      recoloured[static_cast<std::size_t>(object.material)]
                                  ? Mobility::rigid
                                  : Mobility::still;
    }
}

/// Seconds at which the film begins, as far as the file says.
core::Rational first_time(const Animation& animation) {
    if (!animation.first_frame || !animation.frame_rate) return {0, 1};
    return core::time_of(*animation.first_frame, core::frame_rate_from(*animation.frame_rate));
}
double first_second(const Animation& animation) {
    return first_time(animation).value();
}

void set_origin_and_bounds(Animation& animation) {
    animation.origin = glm::dvec3(0);
    animation.bounds_min = animation.bounds_max = glm::vec3(0);
    const std::optional<Extent> extent = extent_at(animation, first_second(animation));
    if (!extent) return;

    // Recentre only a scene that is far away beside its size; by a single precision number, so that vertices that lie
    // far away in their own mesh are moved without rounding. chosen: 8 radii, where rounding moves a point by 2e-4
    // pixels in a picture of 1000; at 64 it would be 1e-3. Most scenes stay in their own coordinates, and twice the
    // scene is twice every number.
    const glm::dvec3 centre = extent->centre();
    if (glm::length(centre) > 8 * extent->radius()) animation.origin = glm::dvec3(glm::vec3(centre));
    animation.bounds_min = glm::vec3(extent->low - animation.origin);
    animation.bounds_max = glm::vec3(extent->high - animation.origin);
}

void set_duration(Animation& animation) {
    animation.duration = 0;
    if (animation.frame_rate)
        for (const Volume& volume : animation.volumes)
            if (volume.files.size() > 1)
                animation.duration =
                    std::max(animation.duration,
                             core::time_of(volume.first_frame + static_cast<std::int64_t>(volume.files.size()),
                                           core::frame_rate_from(*animation.frame_rate))
                                 .value());
    for (const Track& track : animation.tracks)
        if (varies(track)) animation.duration = std::max(animation.duration, static_cast<double>(track.times.back()));
}

}  // namespace

void suggest_rate(Animation& animation) {
    if (animation.frame_rate) return;
    std::vector<float> times;
    for (const Track& track : animation.tracks) times.insert(times.end(), track.times.begin(), track.times.end());
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    // Fewer keys may lie on frames of any rate by chance.
    constexpr std::size_t least_keys = 4;
    if (times.size() < least_keys) return;
    std::optional<std::string> found;
    for (const char* name : {"24", "25", "30", "23.976", "29.97", "50", "60", "59.94"}) {
        const double rate = core::frame_rate_from(name).hertz.value();
        if (!are_frames(times, rate)) continue;
        // Frames of 25 are frames of 50 as well; but frames of both 24 and 25 are seconds, which suggest nothing.
        const bool is_multiple =
            found && are_frames({static_cast<float>(1 / core::frame_rate_from(*found).hertz.value())}, rate);
        if (found && !is_multiple) return;
        if (!found) found = name;
    }
    if (!found || *found == "25") return;
    animation.frame_rate = found;
    note_once(animation, "keys lie " + *found + " to the second, and so do the film's pictures (--fps)");
}

void complete(Animation& animation, DefaultLight light) {
    // Check, in the order in which the checks rely on each other.
    validate_nodes(animation);
    validate_meshes(animation);
    validate_looks(animation);
    validate_objects(animation);
    validate_lights(animation);
    validate_volumes(animation);
    validate_cameras(animation);
    validate_tracks(animation);

    // Derive.
    set_mobility(animation);
    set_duration(animation);
    set_bodies(animation, first_second(animation));
    suggest_rate(animation);
    const bool dark = !has_light(animation);
    View view = View::orbit;
    if (animation.cameras.empty()) {
        const AutomaticCamera camera = add_automatic_camera(animation, dark && light == DefaultLight::studio);
        note_once(animation, camera.note);
        view = camera.view;
        set_duration(animation);
    } else if (animation.cameras.size() > 1 && animation.shots.empty()) {
        const std::string& name = animation.cameras.front().name;
        note_once(animation, core::counted(animation.cameras.size(), "camera") + " and no choice: the first is used" +
                                 (name.empty() ? "" : ", " + in_quotes(name)));
    }
    if (dark && light != DefaultLight::none)
        note_once(animation, add_default_light(animation, first_second(animation), light, view));
    set_origin_and_bounds(animation);
    note_lost_objects(animation, first_second(animation));
    validate_reflections(animation, first_time(animation));
}

}  // namespace render2mpeg::scene
