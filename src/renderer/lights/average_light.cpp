// The average of all light over a film.
#include "renderer/lights/light_points.h"

#include <algorithm>

namespace render2mpeg::renderer {
namespace {

/// Instants that a mean is taken of. chosen: 64; a flash between two of them counts through its keys.
constexpr int average_instants = 64;
/// Of the largest strength, what the average is at least. chosen: a tenth; not tuned.
constexpr float least_of_largest = 0.1f;

/// A factor's average over the film.
float average_factor(const scene::Track& track, double duration) {
    double sum = 0;
    float largest = 0;
    const auto look = [&](double seconds) {
        float value = 0;
        track.sample(seconds, {&value, 1});
        value = std::max(0.0f, value);
        largest = std::max(largest, value);
        return value;
    };
    for (int i = 0; i < average_instants; ++i) sum += look(duration * (i + 0.5) / average_instants);
    for (const float key : track.times) look(key);
    return std::max(static_cast<float>(sum / average_instants), least_of_largest * largest);
}

}  // namespace

scene::Snapshot with_average_light(const scene::Snapshot& snapshot) {
    const scene::Animation& film = *snapshot.animation;
    scene::Snapshot average = snapshot;
    std::fill(average.emission_factor.begin(), average.emission_factor.end(), 1.0f);
    for (scene::LightState& light : average.lights)
        light.intensity = glm::min(film.lights[light.id].color * film.lights[light.id].intensity, glm::vec3(1e30f));
    for (const scene::Track& track : film.tracks) {
        if (track.index < 0 || track.width != 1) continue;
        const auto index = static_cast<std::size_t>(track.index);
        if (track.target == scene::TrackTarget::emission && index < average.emission_factor.size())
            average.emission_factor[index] = average_factor(track, film.duration);
        if (track.target != scene::TrackTarget::light_intensity) continue;
        for (scene::LightState& light : average.lights)
            if (light.id == index) light.intensity *= average_factor(track, film.duration);
    }
    return average;
}

}  // namespace render2mpeg::renderer
