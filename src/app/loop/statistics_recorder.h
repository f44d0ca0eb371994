#pragma once
// Records the statistics of pictures between their making and their coding.
#include <cstdint>
#include <map>

#include "app/loop/run_statistics.h"
#include "core/picture.h"
#include "encoder/types.h"
#include "renderer/renderer.h"

namespace render2mpeg::app {

/// The pictures of a chunk between their making and their coding, with what is known of them. Frames come one after
/// the other; their entries are added to the statistics.
class StatisticsRecorder {
  public:
    explicit StatisticsRecorder(RunStatistics& statistics)
        : statistics_(statistics), first_(statistics.frames.size()) {}

    /// Opens the entry of a frame with what gathering its light took: the growth of the renderer's counts.
    void rendered(std::int64_t frame, const renderer::Statistics& before, const renderer::Statistics& after);
    /// Opens the entry of a frame that came from a file.
    void opened(std::int64_t frame) { rendered(frame, {}, {}); }
    /// Adds pixels of that frame that were gathered again.
    void audited(const std::vector<renderer::AuditedPixel>& pixels, const core::ToleranceMap& tolerance);
    /// CPU seconds of the frame opened last.
    void took(double seconds) { statistics_.frames.back().seconds = seconds; }
    /// Keeps a picture until it is coded.
    void keep(core::Picture picture);
    /// Completes the entry of a picture that was coded.
    void coded(const encoder::CodedPicture& coded);

  private:
    RunStatistics& statistics_;
    std::size_t first_;
    std::map<std::int64_t, core::Picture> waiting_;
};

}  // namespace render2mpeg::app
