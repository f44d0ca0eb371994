#pragma once
// Renders into a pipe instead of a file.
#include <string>

#include "app/files/output_stream.h"
#include "app/loop/observer.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/loop/sink.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// `render -o -`: keeps nothing for a later run and decodes nothing again. Returns the exit status.
int render_stream(const RenderOptions& options, const std::string& command);

/// A coded film.
class CodedStream : public Sink {
  public:
    CodedStream(OutputStream& out, const std::filesystem::path& name, const Film& film) : stream_(out, name, film) {}
    void coded(const encoder::CodedPicture& picture) override { stream_.write(picture); }
    void finish() override { stream_.finish(); }

  private:
    FilmStream stream_;
};

/// Writes the film to a stream of the kind of `name`'s ending: .ts, .m2v or .y4m.
std::unique_ptr<Sink> stream_into(OutputStream& out, const std::filesystem::path& name, const RenderJob& film);

}  // namespace render2mpeg::app
