#include "app/options/unused_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>

#include "app/options/chunk.h"

namespace render2mpeg::app {
namespace {

using Names = std::vector<std::string>;

/// Adds a line if any of these options was given.
void note(Names& lines, const Names& given, const Names& names, const std::string& reason) {
    Names found;
    for (const std::string& name : names)
        if (std::find(given.begin(), given.end(), name) != given.end()) found.push_back(name);
    if (!found.empty())
        lines.push_back(
            fmt::format("{} {} nothing here: {}", fmt::join(found, ", "), found.size() == 1 ? "does" : "do", reason));
}

}  // namespace

std::vector<std::string> unused_options(const RenderOptions& options, OutputKind kind,
                                        const ToleranceRequest& tolerance) {
    Names lines;
    const std::string output = options.output.filename().string();
    if (kind != OutputKind::film)
        note(lines, options.given,
             {"--codec", "--quantiser", "--crf", "--quality", "--bitrate", "--cbr", "--maxrate", "--vbv", "--passes",
              "--gop", "--b-pictures", "--tune", "--encoder", "--keyframes", "--audio", "--audio-offset"},
             output + " is not coded");
    // With a tolerance, the exposure says how dark a pixel is too dark to matter.
    if (kind == OutputKind::exr && (tolerance.reference || tolerance.relative == 0))
        note(lines, options.given, {"--exposure"},
             output + " holds the scene's own light, and no light is too dark for this tolerance");
    if (kind == OutputKind::exr)
        note(lines, options.given, {"--view", "--glare"}, output + " holds the scene's own light");
    if (tolerance.truth)
        note(lines, options.given, {"--vpls", "--clamp", "--cache", "--samples", "--edge-samples"},
             "paths over the whole pixel bring its light");
    if (!tolerance.coupled)
        note(lines, options.given, {"--masking"}, "the tolerance is not coupled to the film's coding");
    return lines;
}

std::vector<std::string> unused_options(const EncodeOptions& options) {
    Names lines;
    if (!options.motion) note(lines, options.given, {"--motion-convention"}, "there is no --motion");
    return lines;
}

std::string unused_keyframes(const Keyframes& keyframes, const FrameRange& frames) {
    const auto outside = std::count_if(keyframes.frames.begin(), keyframes.frames.end(),
                                       [&](std::int64_t frame) { return frame < frames.first || frame > frames.last; });
    if (outside == 0) return {};
    return fmt::format("--keyframes: {} of {} {} no frame{} of the film, which has {} to {}", outside,
                       keyframes.frames.size(), outside == 1 ? "is" : "are", outside == 1 ? "" : "s", frames.first,
                       frames.last);
}

std::string keyframes_without_chapter(const Film& film) {
    if (!film.disc) return {};
    // libavformat begins a unit with a GOP this many seconds after the one before (docs/coding.md).
    const double apart = 0.4 * film.coding.rate.hertz.value();
    std::vector<std::int64_t> lost;
    std::int64_t unit = film.frames.first, gop = film.frames.first;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop))
        for (std::int64_t n = chunk.first; n <= chunk.last; ++n) {
            const bool keyframe = film.keyframes.begins_at(n);
            if (n != chunk.first && !keyframe && n - gop < film.coding.gop) continue;
            gop = n;
            if (n == film.frames.first) continue;
            const bool begins_unit = static_cast<double>(n - unit) >= apart;
            if (begins_unit) unit = n;
            if (keyframe && !begins_unit) lost.push_back(n);
        }
    if (lost.empty()) return {};
    return fmt::format("--keyframes: no chapter can begin at {}: a group of pictures begins less than 0.4 s before",
                       fmt::join(lost, ", "));
}

}  // namespace render2mpeg::app
