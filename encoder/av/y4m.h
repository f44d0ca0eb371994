#pragma once
// Writes uncompressed pictures as YUV4MPEG2, to files or piece by piece.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>

#include "core/picture.h"
#include "core/rational.h"

namespace render2mpeg::av {

/// The first line of a YUV4MPEG2 stream [Y4M] of such pictures, as Y4mWriter writes them.
std::string y4m_header(int width, int height, const core::FrameRate& rate, core::Rational pixel_aspect);

/// Hands over a picture as it stands in such a stream, piece by piece, until `sink` returns false.
void put_y4m_frame(const core::Picture& picture, const std::function<bool(std::span<const std::uint8_t>)>& sink);

/// Writes uncompressed pictures as YUV4MPEG2 [Y4M]: 8-bit 4:2:0 with MPEG-2's chroma siting, limited range. The file
/// has a temporary name beside the wanted one until it is whole. Needs no outside library.
class Y4mWriter {
  public:
    /// `pixel_aspect` is width by height of a pixel. Throws core::Error if the file cannot be written.
    Y4mWriter(const std::filesystem::path& file, int width, int height, const core::FrameRate& rate,
              core::Rational pixel_aspect = {1, 1});
    /// Removes the temporary file unless finish() was called.
    ~Y4mWriter();
    Y4mWriter(const Y4mWriter&) = delete;
    Y4mWriter& operator=(const Y4mWriter&) = delete;

    /// Pictures in display order, of the size that was announced. Throws core::Error if the disk is full.
    void write(const core::Picture& picture);
    /// Closes the file and gives it its name. Throws core::Error.
    void finish();

  private:
    void check(const char* doing);

    std::filesystem::path file_, temporary_;
    int width_, height_;
    std::ofstream stream_;
    bool finished_ = false;
};

}  // namespace render2mpeg::av
