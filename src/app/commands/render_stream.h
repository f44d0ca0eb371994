#pragma once
// Renders into a pipe instead of a file.
#include <functional>
#include <string>

#include "app/files/output_stream.h"
#include "app/loop/observer.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// `render -o -`: keeps nothing for a later run and decodes nothing again. Returns the exit status.
int render_stream(const RenderOptions& options, const std::string& command);

/// Renders a settled film chunk by chunk while `goes_on` says so. Returns whether it is whole.
bool render_through(const RenderJob& film, LoopObserver& observer, RunStatistics& statistics,
                    const std::function<bool()>& goes_on);

/// Writes the film to a stream of the kind of `name`'s ending: .ts, .m2v or .y4m.
class StreamObserver : public LoopObserver {
  public:
    virtual void finish() = 0;
};
std::unique_ptr<StreamObserver> stream_into(OutputStream& out, const std::filesystem::path& name,
                                            const RenderJob& film);

}  // namespace render2mpeg::app
