#include "app/files/sound.h"

#include "app/system/probes.h"
#include "core/error.h"
#include "encoder/av/av.h"

namespace render2mpeg::app {

av::Sound sound_of(const CodingOptions& options, const std::optional<std::filesystem::path>& scenes,
                   const std::filesystem::path& output, const FrameRange& frames, const core::FrameRate& rate) {
    const bool none = options.audio && *options.audio == "none";
    if (none || !av::is_film(output) || (!options.audio && !scenes)) return {};
    if (!av::can_have_sound(output)) {
        if (!options.audio) return {};
        throw core::Error("--audio: " + output.string() +
                          " is an elementary stream, which has no sound; .mpg, .ts, .mkv and .mp4 have");
    }
    av::Sound sound;
    sound.file = options.audio ? std::filesystem::path(*options.audio) : *scenes;
    sound.offset = options.audio_offset - static_cast<double>(frames.first) / rate.hertz.value();
    sound.ac3 = options.preset.has_value();
    probe_sound(sound.file);
    return sound;
}

}  // namespace render2mpeg::app
