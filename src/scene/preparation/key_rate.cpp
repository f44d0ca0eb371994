#include "scene/preparation/key_rate.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/rational.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene {
namespace {

/// Whether all times are whole frames of a rate, as far as single precision tells.
bool are_frames(const std::vector<float>& times, double rate) {
    return std::all_of(times.begin(), times.end(), [rate](float time) {
        const double frame = static_cast<double>(time) * rate;
        return std::abs(frame - std::round(frame)) < 2e-3 + 4e-7 * frame;
    });
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

}  // namespace render2mpeg::scene
