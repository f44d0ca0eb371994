#pragma once
// Records the statistics of pictures between their making and their coding.
#include <cstdint>
#include <map>

#include "app/loop/observer.h"
#include "app/loop/run_statistics.h"
#include "core/picture.h"
#include "encoder/types.h"
#include "renderer/renderer.h"

namespace render2mpeg::app {

/// Adds an entry for every frame of a chunk to the statistics. Frames come one after the other.
class StatisticsRecorder : public LoopObserver {
  public:
    /// `coded`: pictures are going to be coded, and kept until then.
    StatisticsRecorder(RunStatistics& statistics, bool coded)
        : statistics_(statistics), first_(statistics.frames.size()), coded_(coded) {}

    /// Opens the entry of a frame with what gathering its light took: the growth of the renderer's counts.
    void lit(const LitFrame& frame) override;
    /// Completes the entry of a picture that was coded.
    void coded(const encoder::CodedPicture& coded) override;
    /// Opens the entry of a frame that came from a file.
    void read(const core::Picture& picture);

  private:
    RunStatistics& statistics_;
    std::size_t first_;
    bool coded_;
    std::map<std::int64_t, core::Picture> waiting_;
};

/// Gathers some pixels of every frame again without clustering, and adds their errors to the statistics.
class Auditor : public LoopObserver {
  public:
    /// `pixels` of each frame.
    Auditor(renderer::Renderer& renderer, int pixels, RunStatistics& statistics)
        : renderer_(renderer), pixels_(pixels), statistics_(statistics) {}

    void lit(const LitFrame& frame) override;

  private:
    renderer::Renderer& renderer_;
    int pixels_;
    RunStatistics& statistics_;
};

}  // namespace render2mpeg::app
