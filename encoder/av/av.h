#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "core/picture.h"
#include "encoder/av/sound.h"
#include "encoder/types.h"

/// FFmpeg's part: containers, and decoding for verification. Its libraries are opened on demand.
namespace render2mpeg::av {

/// Whether a file name's ending is a container or elementary stream that Muxer writes: mpg, mpeg, vob, ts, m2v, mkv,
/// mp4, mov. Case does not matter.
bool is_film(const std::filesystem::path& file);

/// Whether films of this ending can say that their pictures are panoramas, or for two eyes.
bool tells_immersive(const std::filesystem::path& name);

/// Whether films of this ending can have chapters; a title; and, of this codec, a timecode.
bool can_have_chapters(const std::filesystem::path& name);
bool can_have_title(const std::filesystem::path& name);
bool can_have_timecode(const std::filesystem::path& name, encoder::Codec codec);

/// Throws core::Error where players do not look for a codec in files of this ending.
void check_container(const std::filesystem::path& name, encoder::Codec codec);

/// Which program streams .mpg, .mpeg and .vob are. `dvd`: sectors of 2048 bytes at 10.08 Mb/s, with a navigation pack
/// before each video object unit, as tools that make DVDs take them; for streams of at most 9.8 Mb/s.
enum class ProgramStream { plain, dvd };

/// Opens FFmpeg's libraries. Throws core::Error where their module is missing.
void open_libraries();

/// Opens what films of this name, codec and sound are made with and proved by: FFmpeg's libraries, the container's
/// writer, the decoder, the sound's encoder. Throws core::Error, naming what is missing.
void check_film(const std::filesystem::path& name, encoder::Codec codec, const Sound& sound = {},
                ProgramStream program_stream = ProgramStream::plain);

/// Takes the bytes of a film as they come, in order; false: it takes no more. Throws nothing.
using ByteSink = std::function<bool(std::span<const std::uint8_t>)>;

/// Writes coded pictures to a file of the kind that `name`'s ending tells: mpg, mpeg and vob are program
/// streams of MPEG-2. The same pictures give the same bytes: no dates, no random identifiers.
class Muxer {
  public:
    /// `file` is where bytes go; `name` (often the final name) chooses the format. `largest_picture` is the size in
    /// bytes of the film's largest coded picture if it is known, else 0: a program stream declares at its very start
    /// how fast and into how large a buffer its pictures come, and without it guesses from the first picture and the
    /// sequence header. `program_stream` matters to program streams only. Throws core::Error if the ending is none of
    /// ours, if the file cannot be created, or if there is sound and the ending is one that cannot have any.
    Muxer(const std::filesystem::path& file, const std::filesystem::path& name, const encoder::Settings& settings,
          std::size_t largest_picture = 0, ProgramStream program_stream = ProgramStream::plain,
          const Sound& sound = {});
    /// The same without a file: a transport stream or an elementary stream (.ts, .m2v), each picture's bytes handed to
    /// `sink` within write().
    Muxer(ByteSink sink, const std::filesystem::path& name, const encoder::Settings& settings, const Sound& sound = {});
    /// Closes the file; it is not whole unless finish() was called.
    ~Muxer();
    Muxer(const Muxer&) = delete;
    Muxer& operator=(const Muxer&) = delete;

    /// One access unit in coding order. `display_number` and `coding_order` count from the film's first picture. The
    /// first one begins with the stream's headers. Pictures are shown as they are decoded where the film has no B
    /// pictures, else one picture later, or two where B pictures are referred to. Throws core::Error if the disk is
    /// full, and for pictures of another size or out of order.
    void write(std::span<const std::uint8_t> bytes, std::int64_t display_number, std::int64_t coding_order,
               bool starts_gop);
    /// Writes trailers and closes. Without it the file is not whole. Returns how loud the sound is; none: silent.
    /// Throws core::Error, also for a film without pictures.
    std::optional<Loudness> finish();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Decodes a film with libavcodec (`-idct simple`) and hands over its pictures in display order, numbered from 0, 4:2:0
/// planes cropped to the display size. Throws core::Error on the first decoding error, with libavcodec's message; what
/// libavcodec would conceal counts as an error.
void decode(const std::filesystem::path& file, const std::function<void(const core::Picture&)>& picture);

}  // namespace render2mpeg::av
