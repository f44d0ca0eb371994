#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "app/options/shape.h"
#include "core/rational.h"
#include "core/view.h"
#include "encoder/av/sound.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// A run of frames that shares state and depends on no other: the unit of resuming and of parallel rendering.
struct Chunk {
    int index = 0;
    std::int64_t first = 0, last = 0;  ///< frames, both inclusive

    std::int64_t frames() const { return last - first + 1; }
};

/// Chunks that follow each other, by their index.
struct ChunkRange {
    std::size_t first = 0, last = 0;  ///< both inclusive

    std::size_t count() const { return last - first + 1; }
};

/// Cuts a film into chunks of a whole number of closed GOPs on a fixed grid from its first frame. A function of the
/// film alone, never of threads or machines.
std::vector<Chunk> chunks_of(FrameRange frames, int gop);

/// Frames at which a GOP begins whatever is seen (`--keyframes`), ascending.
struct Keyframes {
    std::vector<std::int64_t> frames;

    bool begins_at(std::int64_t frame) const;
    /// How many frames follow `frame` before the next one begins a GOP; at most `left`.
    std::int64_t frames_left(std::int64_t frame, std::int64_t left) const;
};

/// Reads "0,48,96", or the name of a file with frame numbers between spaces, commas and line ends, where `#` begins a
/// comment. Frames that a film does not have are allowed: a part of a film is cut as the whole. Throws core::Error,
/// also where there is no number at all.
Keyframes keyframes_from(const std::string& text);

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
