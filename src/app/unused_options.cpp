#include "app/unused_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

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
             {"--quantiser", "--quality", "--bitrate", "--cbr", "--maxrate", "--vbv", "--passes", "--gop",
              "--b-pictures", "--tune", "--encoder", "--keyframes"},
             output + " is not coded");
    // With a tolerance, the exposure says how dark a pixel is too dark to matter.
    if (kind == OutputKind::exr && (tolerance.reference || tolerance.relative == 0))
        note(lines, options.given, {"--exposure"},
             output + " holds the scene's own light, and no light is too dark for this tolerance");
    if (!tolerance.coupled)
        note(lines, options.given, {"--masking"}, "the tolerance is not coupled to the film's coding");
    if (tolerance.reference)
        note(lines, options.given, {"--stop"}, "with --tolerance reference every light point is gathered");
    return lines;
}

std::vector<std::string> unused_options(const EncodeOptions& options) {
    Names lines;
    if (!options.motion) {
        note(lines, options.given, {"--motion-convention"}, "there is no --motion");
        note(lines, options.given, {"--b-pictures"}, "without --motion films are coded without B pictures");
    }
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

}  // namespace render2mpeg::app
