#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/picture.h"
#include "encoder/encoder.h"

/// FFmpeg's part: containers, and decoding for verification. Its libraries are opened on demand.
namespace render2mpeg::av {

/// Whether a file name's ending is a container or elementary stream that Muxer writes: mpg, vob, ts, m2v, mkv, mp4.
bool is_film(const std::filesystem::path& file);

/// Writes coded pictures to a file of the kind that `name`'s ending tells.
class Muxer {
 public:
    /// `file` is where bytes go; `name` (often the final name) chooses the format. Throws core::Error.
    Muxer(const std::filesystem::path& file, const std::filesystem::path& name, const encoder::Settings& settings);
    ~Muxer();

    /// One access unit in coding order. `display_number` and `coding_order` count from the film's first picture.
    void write(std::span<const std::uint8_t> bytes, std::int64_t display_number, std::int64_t coding_order, bool starts_gop);
    /// Writes trailers and closes. Without it the file is not whole.
    void finish();

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Decodes a film with libavcodec (`-idct simple`) and hands over its pictures in display order, 4:2:0 planes cropped to the
/// display size. Throws core::Error on the first decoding error, with libavcodec's message.
void decode(const std::filesystem::path& file, const std::function<void(const core::Picture&)>& picture);

}  // namespace render2mpeg::av
