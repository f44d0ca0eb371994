#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/loop/pipeline.h"
#include "app/report/frame_view.h"

namespace render2mpeg::app {

/// Keeps the middle of one frame of a render for its report: as it was lit and as it is decoded, and what its light may
/// be off by.
class FramePortrait : public Watcher {
  public:
    /// The frame in the middle of the film.
    explicit FramePortrait(const Production& film);

    void lit(const LitFrame& frame) override;
    void coded(const encoder::CodedPicture& coded) override;

    /// For a page: a slider where the frame was coded, and false colours where its tolerances differ. Empty where the
    /// frame was not made.
    std::string figures() const;

  private:
    std::int64_t frame_;
    perceptual::ColorMatrix matrix_;
    std::optional<core::Picture> lit_, decoded_;
    core::Plane<float> tolerance_, error_;  ///< over luminance; empty: not known
    std::string coding_;                    ///< "a B picture, quantiser 6, 1.2 kB"
};

/// Several that look on at once.
class Watchers : public Watcher {
  public:
    void add(Watcher& watcher) { all_.push_back(&watcher); }
    bool empty() const { return all_.empty(); }
    void lit(const LitFrame& frame) override {
        for (Watcher* watcher : all_) watcher->lit(frame);
    }
    void coded(const encoder::CodedPicture& picture) override {
        for (Watcher* watcher : all_) watcher->coded(picture);
    }
    void begins(const Chunk& chunk) override {
        for (Watcher* watcher : all_) watcher->begins(chunk);
    }
    void ends(const Chunk& chunk) override {
        for (Watcher* watcher : all_) watcher->ends(chunk);
    }

  private:
    std::vector<Watcher*> all_;
};

}  // namespace render2mpeg::app
