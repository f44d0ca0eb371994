#pragma once
// What the FFmpeg module offers to the light library in front of it (av.cpp).
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "core/picture.h"
#include "encoder/av/av.h"
#include "encoder/av/inspect.h"
#include "encoder/av/sequence_facts.h"
#include "encoder/av/sound.h"
#include "encoder/types.h"

/// What the module render2mpeg_av_module.so offers to the light library in front of it (av.cpp). Nothing else includes
/// this.
namespace render2mpeg::av {

/// When a coded picture is shown and decoded, in fields from the film's beginning (encoder/cadence.h).
struct Times {
    std::int64_t presentation = 0, decoding = 0, duration = 2;
};

/// A film file being written.
class Container {
  public:
    virtual ~Container() = default;
    virtual void write(std::span<const std::uint8_t> bytes, const Times& times, bool random_access) = 0;
    virtual void finish() = 0;
};

class Backend {
  public:
    virtual ~Backend() = default;
    /// Creates `file` as libavformat's `format`, for a stream with these facts and this sound. With a `sink` the bytes
    /// go there, and `file` is no more than what messages call it.
    virtual std::unique_ptr<Container> create(const std::filesystem::path& file, const ByteSink& sink,
                                              const char* format, const encoder::Settings& settings,
                                              const SequenceFacts& facts, const Sound& sound) const = 0;
    virtual double length_of_sound(const std::filesystem::path& file) const = 0;
    virtual void decode(const std::filesystem::path& file,
                        const std::function<void(const core::Picture&)>& picture) const = 0;
    virtual Inspection inspect(const std::filesystem::path& file) const = 0;
};

}  // namespace render2mpeg::av
