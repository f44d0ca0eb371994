#pragma once
// Reads uncompressed pictures from YUV4MPEG2 files.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "core/picture.h"
#include "encoder/av/y4m_samples.h"

/// Reads uncompressed pictures from YUV4MPEG2 [Y4M].
namespace render2mpeg::av {

/// Reads uncompressed pictures from a YUV4MPEG2 file [Y4M], progressive, as y4m_samples.h says. Needs no outside
/// library.
class Y4mReader {
  public:
    /// `chroma`: of pictures of more than 8-bit 4:2:0. Throws core::Error for files that are cut off or damaged,
    /// and, by name, for kinds that are not read.
    explicit Y4mReader(const std::filesystem::path& file, core::ExactChroma chroma = core::ExactChroma::none);

    const Y4mFormat& format() const { return format_; }
    std::int64_t frames() const { return static_cast<std::int64_t>(offsets_.size()); }

    /// A picture by its place in the file, from 0; any order.
    core::Picture read(std::int64_t frame);

  private:
    void find_frames();

    std::filesystem::path file_;
    std::ifstream stream_;
    Y4mFormat format_;
    core::ExactChroma chroma_;
    std::vector<std::uint64_t> offsets_;  ///< of each frame's first sample
};

/// Reads the same from a pipe: one picture after the other, none twice.
class Y4mPipe {
  public:
    /// Waits for the header. `stream` must outlive it; messages call it `name`. Throws as Y4mReader does.
    Y4mPipe(std::istream& stream, std::string name, core::ExactChroma chroma = core::ExactChroma::none);

    const Y4mFormat& format() const { return format_; }

    /// Waits for the next picture, numbered from 0; none where the stream ends behind a whole one. Throws core::Error.
    std::optional<core::Picture> next();

  private:
    std::istream& stream_;
    std::string name_;
    Y4mFormat format_;
    core::ExactChroma chroma_;
    std::int64_t frames_ = 0;  ///< that were read
};

}  // namespace render2mpeg::av
