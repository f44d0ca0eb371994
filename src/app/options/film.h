#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/options/keyframes.h"
#include "app/options/options.h"
#include "app/options/preset.h"
#include "app/options/shape.h"
#include "core/rational.h"
#include "core/view.h"
#include "encoder/av/sound.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// What a coded film is, wherever its pictures come from.
struct Film {
    std::string source;  ///< file that the pictures are made from
    FrameRange frames;
    encoder::Settings coding;
    Keyframes keyframes;
    bool disc = false;  ///< program streams are a DVD's
    std::string isa;    ///< instruction set that the pictures depend on; empty: on none
    av::Sound sound;    ///< without its end, which is the film's

    std::int64_t frame_count() const { return frames.last - frames.first + 1; }
};

/// The preset that the options name, or null.
const Preset* preset_of(const CodingOptions& options);

/// The codec that the options name; else the one of the output's ending: H.264 for .mp4, .mov and .mkv, MPEG-2 for all
/// others and for none. Throws UsageError where a preset has no such codec.
encoder::Codec codec_of(const CodingOptions& options, const std::filesystem::path& output);

/// Throws UsageError where a film cannot be coded with these settings, or not here (encoder/av/coders.h).
void check_settings(const encoder::Settings& coding);

/// The ending that films of a codec usually have.
inline const char* usual_ending(encoder::Codec codec) {
    return codec == encoder::Codec::mpeg2 ? ".mpg" : ".mp4";
}

/// MPEG-2's quantisers in a codec's own scale.
std::vector<int> in_scale_of(encoder::Codec codec, std::vector<int> quantisers);

/// The encoder's settings for pictures of this shape, with the matrix that their height asks for; `first` is the film's
/// first frame, `output` its file, or empty. Throws core::Error where an option contradicts the preset or the codec.
encoder::Settings coding_settings(const CodingOptions& options, const Shape& shape, std::int64_t first,
                                  const std::filesystem::path& output);

/// transfer_characteristics of a film with this view: Blender's are none that MPEG-2 has a number for.
inline int transfer_of(const core::View& view) {
    return view.name == core::ViewName::neutral ? 1 : 2;
}

/// The keyframes that the options name.
Keyframes keyframes_of(const CodingOptions& options);

}  // namespace render2mpeg::app
