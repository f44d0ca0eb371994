#pragma once
// Renders into a pipe instead of a file.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/files/output_stream.h"
#include "app/job/render_job.h"
#include "app/loop/sink.h"
#include "app/options/options.h"
#include "encoder/av/av.h"

namespace render2mpeg::app {

/// `render -o -`: keeps nothing for a later run and decodes nothing again. Returns the exit status.
int render_stream(const RenderOptions& options, const std::string& command);

/// A coded film as a transport or elementary stream, by the ending of `name`: .ts or .m2v. Writes each picture when the
/// next one comes, since the last carries the end code. Throws core::Error.
class CodedStream : public Sink {
  public:
    CodedStream(OutputStream& out, const std::filesystem::path& name, const Film& film);
    void coded(const encoder::CodedPicture& picture) override;
    void finish() override;

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
    std::int64_t passed_on_ = 0;  ///< pictures
    std::optional<Waiting> waiting_;
};

/// Writes the film to a stream of the kind of `name`'s ending: .ts, .m2v or .y4m.
std::unique_ptr<Sink> stream_into(OutputStream& out, const std::filesystem::path& name, const RenderJob& film);

}  // namespace render2mpeg::app
