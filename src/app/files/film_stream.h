#pragma once
// A film on its way into a pipe, picture by picture.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "app/files/output_stream.h"
#include "app/options/film.h"
#include "encoder/av/av.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Hands coded pictures on as they come: a transport stream or an elementary one. The last picture carries the end code
/// with it, so that each waits for the next one to come. Throws core::Error where nobody takes them.
class FilmStream {
  public:
    /// `name`'s ending, .ts or .m2v, says which.
    FilmStream(OutputStream& out, const std::filesystem::path& name, const Film& film);

    /// Pictures in coding order.
    void write(const encoder::CodedPicture& picture);
    /// After the last picture; there was one.
    void finish();

  private:
    struct Waiting {
        std::vector<std::uint8_t> bytes;
        std::int64_t number = 0;
        bool starts_gop = false;
    };
    void pass_on();

    OutputStream& out_;
    encoder::Codec codec_;
    std::int64_t first_frame_;
    av::Muxer muxer_;
    std::int64_t coded_ = 0;  ///< pictures passed on
    std::optional<Waiting> waiting_;
};

}  // namespace render2mpeg::app
