#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/job/render_job.h"
#include "app/loop/observer.h"
#include "app/loop/run_statistics.h"
#include "image/cryptomatte.h"

namespace render2mpeg::app {

/// An output that frames go to.
class Sink : public LoopObserver {
  public:
    virtual void finish() {}
};

/// Output of uncoded frames.
class FrameSink : public Sink {
  public:
    using Lit = std::function<void(const LitFrame&)>;
    /// `again`: it begins anew with each run of a chunk.
    explicit FrameSink(
        Lit lit, std::function<void()> finish = [] {}, bool again = false)
        : lit_(std::move(lit)), finish_(std::move(finish)), again_(again) {}
    void lit(const LitFrame& frame) override { lit_(frame); }
    void lit_before(const LitFrame& frame) override {
        if (again_) lit_(frame);
    }
    void finish() override { finish_(); }

  private:
    Lit lit_;
    std::function<void()> finish_;
    bool again_;
};

class ChunkWriter : public LoopObserver {
  public:
    explicit ChunkWriter(ChunkFile& file) : file_(file) {}
    void coded(const encoder::CodedPicture& picture) override { file_.append(picture); }

  private:
    ChunkFile& file_;
};

class LayersWriter : public LoopObserver {
  public:
    LayersWriter(std::filesystem::path folder, const RenderJob& film, RunStatistics& statistics);
    void lit(const LitFrame& frame) override;

  private:
    std::filesystem::path folder_;
    const RenderJob& film_;
    RunStatistics& statistics_;
    image::MatteNames names_;
};

/// Shows progress: the last lit frame as a PNG, once a second.
class LastFrameWriter : public LoopObserver {
  public:
    LastFrameWriter(std::filesystem::path file, const RenderJob& film) : file_(std::move(file)), film_(film) {}
    void lit(const LitFrame& frame) override;

  private:
    std::filesystem::path file_;
    const RenderJob& film_;
    std::mutex mutex_;    ///< chunks are lit beside each other
    double written_ = 0;  ///< clock_seconds(); 0: not yet
};

/// A Y4M file, or numbered images, which appear when they are whole; null for a film. `film` must outlive it.
std::unique_ptr<Sink> make_sink(const RenderJob& film, const std::filesystem::path& output);

/// Joins Y4M files of consecutive chunks.
void join_y4m(const RenderJob& film, const std::vector<std::filesystem::path>& parts,
              const std::filesystem::path& file);

}  // namespace render2mpeg::app
