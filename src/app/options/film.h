#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "app/options/shape.h"
#include "core/view.h"
#include "encoder/av/sound.h"
#include "encoder/codec.h"
#include "encoder/types.h"
#include "perceptual/display.h"

namespace render2mpeg::app {

struct Effort {
    const char* name;
    double loss = usual_loss;  ///< of films, dB
    float fixed = 0.02f;       ///< tolerance of frames
    int samples = 4;           ///< eye samples of a pixel
    int edge_samples = 0;      ///< of pixels with edges; 0: as many as films and frames have
    int most_samples = 256;    ///< of pixels whose edges could show all the same
};

/// Efforts beside the draft. chosen: low loosens in the order of `tune --max-time`; high has a third of the loss and
/// four times the edges' samples (docs/choosing.md).
inline constexpr std::array efforts{Effort{"low", 9 * usual_loss, 0.08f, 1, 4, 0}, Effort{"default"},
                                    Effort{"high", usual_loss / 3, 0.01f, 4, 64, 256}};

const Effort& effort_from(const std::string& name);

/// Options with --effort applied; `draft` is --preview in the film's own size.
RenderOptions with_effort(const RenderOptions& options);

/// Options with a draft's coarse light, few samples and quick coding where none are given (docs/pictures.md). Throws
/// UsageError, naming an option that drafts do not have.
RenderOptions preview_options(const RenderOptions& options);

/// Independent run of frames: the unit of resuming and of parallel rendering.
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

/// Chunks of whole closed GOPs on a fixed grid from the first frame, whatever the machine.
std::vector<Chunk> chunks_of(FrameRange frames, int gop);

struct Keyframes {
    std::vector<std::int64_t> frames;

    bool begins_at(std::int64_t frame) const;
    /// Frames behind `frame` before the next keyframe; at most `left`.
    std::int64_t frames_left(std::int64_t frame, std::int64_t left) const;
};

/// Reads "0,48,96", or a file of numbers between spaces, commas and line ends with `#` comments. Frames outside the
/// film are allowed. Throws core::Error, also for no number.
Keyframes keyframes_from(const std::string& text);

/// A coded film, wherever its pictures come from.
struct Film {
    std::string source;  ///< file that the pictures are made from
    FrameRange frames;
    encoder::Settings coding;
    Keyframes keyframes;
    bool disc = false;  ///< program streams are a DVD's
    std::string isa;    ///< instruction set that the pictures depend on; empty: on none
    av::Sound sound;    ///< without its end, which is the film's

    std::int64_t frame_count() const { return frames.count(); }

    /// The sound, as long as this many pictures.
    av::Sound sound_beside(std::int64_t pictures) const {
        av::Sound ended = sound;
        ended.seconds = static_cast<double>(pictures) / coding.rate.hertz.value();
        return ended;
    }
};

/// Codec by option, else by ending: H.264 for .mp4, .mov and .mkv, VP9 for .webm, GIF for .gif, else MPEG-2. Throws
/// UsageError where a preset does not have it.
encoder::Codec codec_of(const CodingOptions& options, const std::filesystem::path& output);

/// Throws UsageError where a film cannot be coded with these settings, or not here (encoder/av/coders.h).
void check_settings(const encoder::Settings& coding);

bool two_passes(const CodingOptions& options);

/// MPEG-2's quantisers in a codec's own scale.
std::vector<int> in_scale_of(encoder::Codec codec, std::vector<int> quantisers);

/// Throws UsageError for a view or a codec that is none.
ViewAndCodec view_and_codec_from(const std::string& word);

/// Encoder settings for this shape; `first` frame, `output` may be empty. Throws core::Error where an option
/// contradicts preset or codec, UsageError where a film in this view does.
encoder::Settings coding_settings(const CodingOptions& options, const Shape& shape, std::int64_t first,
                                  const std::filesystem::path& output, const core::View& view = {});

/// The view that options ask for, else this one.
core::View view_of(const FilmOptions& options, const core::View& own);
/// Refuses a --peak that no film in this view has. Throws UsageError.
void check_peak(const FilmOptions& options, const core::View& view);

Keyframes keyframes_of(const CodingOptions& options);

}  // namespace render2mpeg::app
