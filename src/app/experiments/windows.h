#pragma once
// Sample windows of a film.
#include <cstdint>
#include <set>
#include <vector>

#include "app/loop/render_job.h"
#include "app/options/film.h"
#include "app/options/options.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Middles of equal parts of the film, as many as there is room for, each coded as a chunk.
std::vector<Chunk> windows_of(FrameRange film, const Sample& sample);

/// The middle frames of each shot, where there are cuts and no more than eight shots; else as windows_of().
std::vector<Chunk> windows_by_shot(const RenderJob& film, const Sample& sample);

/// Reference frames of a window: the last alone, or evenly spaced pairs of neighbours, the last of which ends the
/// window, and an odd one about its middle. `count`: 0 to the window's frames.
std::set<std::int64_t> reference_frames(const Chunk& window, int count);

class GopStarts {
  public:
    void add(const encoder::CodedPicture& picture);
    void add(const GopStarts& others);

    /// Bytes per frame that windows (of `bytes` per frame) take more than the film, since each begins with an I
    /// picture.
    double surplus(const RenderJob& film, const std::vector<Chunk>& windows, double bytes) const;

  private:
    double bytes_ = 0;
    int count_ = 0;
};

}  // namespace render2mpeg::app
