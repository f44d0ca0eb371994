#pragma once
// Interface of the FFmpeg module to the light library in front of it (av.cpp).
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/picture.h"
#include "encoder/av/access_unit.h"
#include "encoder/av/av.h"
#include "encoder/av/inspect.h"
#include "encoder/av/sequence_facts.h"
#include "encoder/av/sound.h"
#include "encoder/av/svt_layers.h"
#include "encoder/types.h"

/// Interface of the module render2mpeg_av_module.so to the light library in front of it (av.cpp, library_coder.cpp).
/// Nothing else includes this.
namespace render2mpeg::av {

/// Whether libavformat's `format` has words for panoramas and two eyes: boxes of MP4, ProjectionPrivate and StereoMode
/// of Matroska. That of QuickTime has them in its files, but libavformat does not write them.
constexpr bool format_tells_immersive(std::string_view format) {
    return format == "mp4" || format == "matroska" || format == "webm";
}

/// Whether libavformat writes chapters, titles and timecodes in its `format`.
constexpr bool format_has_labels(std::string_view format) {
    return format == "mp4" || format == "mov" || format == "matroska" || format == "webm";
}

/// When a coded picture is shown and decoded, in fields from the film's beginning (encoder/cadence.h).
struct Times {
    std::int64_t presentation = 0, decoding = 0, duration = 2;
};

/// A film file being written.
class Container {
  public:
    virtual ~Container() = default;
    /// Pictures and alpha; headers it has from the sequence's facts.
    virtual void write(const AccessUnit& unit, const Times& times, bool random_access) = 0;
    /// Returns how loud its sound is; none: silent.
    virtual std::optional<Loudness> finish() = 0;
};

/// How a library's encoder is to code a picture.
struct LibraryOrder {
    encoder::PictureType type = encoder::PictureType::intra;
    bool starts_gop = true;
    core::Plane<std::uint8_t> quantisers;  ///< of macroblocks; one alone where the codec has one for all
};

/// A picture coded by a library, with its decoded version.
struct LibraryPicture {
    std::int64_t number = 0;
    encoder::PictureType type = encoder::PictureType::intra;
    std::vector<std::uint8_t> bytes, alpha;  ///< alpha: of VP9, else empty
    core::Picture reconstruction;
    core::Plane<encoder::MacroblockRecord> macroblocks;  ///< empty: the decoder does not tell
};

/// An encoder of libavcodec with its decoder beside it, for pictures that depend on no others.
class LibraryEncoder {
  public:
    virtual ~LibraryEncoder() = default;
    /// Headers of the stream, to precede each picture that starts a GOP.
    virtual const std::vector<std::uint8_t>& headers() const = 0;
    /// The next picture in display order.
    virtual void send(const core::Picture& picture, const LibraryOrder& order) = 0;
    /// No picture follows.
    virtual void end() = 0;
    /// Pictures that are complete, in coding order.
    virtual std::vector<LibraryPicture> take() = 0;
};

class Backend {
  public:
    virtual ~Backend() = default;
    /// Creates `file` as libavformat's `format`, for a stream with these facts and this sound. With a `sink` the bytes
    /// go there, and `file` is no more than what messages call it.
    virtual std::unique_ptr<Container> create(const std::filesystem::path& file, const ByteSink& sink,
                                              const char* format, const encoder::Settings& settings,
                                              const SequenceFacts& facts, const Sound& sound) const = 0;
    /// Throws core::Error where films of libavformat's `format` are not written or decoded, or this sound not encoded.
    virtual void check_film(const std::filesystem::path& name, const char* format, encoder::Codec codec,
                            const Sound& sound) const = 0;
    /// Throws core::Error where libavcodec has no encoder for the codec, or none with this bit depth.
    virtual void check_encoder(const encoder::Settings& settings) const = 0;
    /// `offsets` are AV1's alone.
    virtual std::unique_ptr<LibraryEncoder> open_encoder(const encoder::Settings& settings,
                                                         const IndexOffsets& offsets) const = 0;
    virtual int channels_of_sound(const std::filesystem::path& file) const = 0;
    virtual void decode(const std::filesystem::path& file,
                        const std::function<void(const core::Picture&)>& picture) const = 0;
    virtual Inspection inspect(const std::filesystem::path& file) const = 0;
};

/// The module's functions; it is opened by the first call. Throws core::Error.
const Backend& backend();

}  // namespace render2mpeg::av
