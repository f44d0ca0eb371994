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
#include "core/rational.h"

/// Reads uncompressed pictures from YUV4MPEG2 [Y4M].
namespace render2mpeg::av {

/// Picture format from the header of a Y4M file.
struct Y4mFormat {
    /// Where chroma samples lie. `jpeg`: between four luma samples; `mpeg2`: as in core::Picture; `paldv`: on luma
    /// samples of the even columns, Cr in even rows and Cb in odd ones.
    enum class Siting { jpeg, mpeg2, paldv };

    int width = 0, height = 0;
    std::optional<core::Rational> hertz;         ///< pictures per second; none: the file does not say
    std::optional<core::Rational> pixel_aspect;  ///< width by height of a pixel; none: the file does not say
    Siting siting = Siting::jpeg;
    bool full_range = false;  ///< code values 0..255 for black to white
};

/// Reads uncompressed pictures from a YUV4MPEG2 file [Y4M]: 8-bit 4:2:0, progressive. Chroma of other sitings than
/// MPEG-2's is moved by a quarter sample with a cubic filter, full range becomes limited range; what has neither need
/// is handed over bit by bit. Needs no outside library.
class Y4mReader {
  public:
    /// Throws core::Error for files that are cut off or damaged, and, by name, for kinds that are not read.
    explicit Y4mReader(const std::filesystem::path& file);

    const Y4mFormat& format() const { return format_; }
    std::int64_t frames() const { return static_cast<std::int64_t>(offsets_.size()); }

    /// A picture by its place in the file, from 0; any order. `luma` is set only where full range was converted.
    core::Picture read(std::int64_t frame);

  private:
    void find_frames();

    std::filesystem::path file_;
    std::ifstream stream_;
    Y4mFormat format_;
    std::vector<std::uint64_t> offsets_;  ///< of each frame's first sample
};

/// Reads the same from a pipe: one picture after the other, none twice.
class Y4mPipe {
  public:
    /// Waits for the header. `stream` must outlive it; messages call it `name`. Throws as Y4mReader does.
    Y4mPipe(std::istream& stream, std::string name);

    const Y4mFormat& format() const { return format_; }

    /// Waits for the next picture, numbered from 0; none where the stream ends behind a whole one. Throws core::Error.
    std::optional<core::Picture> next();

  private:
    std::istream& stream_;
    std::string name_;
    Y4mFormat format_;
    std::int64_t frames_ = 0;  ///< that were read
};

}  // namespace render2mpeg::av
