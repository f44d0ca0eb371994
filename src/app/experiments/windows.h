#pragma once
// Which frames of a film stand for it.
#include <cstdint>
#include <set>
#include <vector>

#include "app/loop/render_job.h"
#include "app/options/film.h"
#include "app/options/options.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Stretches of a film that stand for it: the middles of equal parts, as many as there is room for, each coded as a
/// chunk of its own.
std::vector<Chunk> windows_of(FrameRange film, const Sample& sample);

/// The frames of a window that are lit by every light point: the last alone, or pairs of adjacent ones at even
/// distances, of which the last ends the window, and an odd one about its middle. `count` is 0 to the window's frames.
std::set<std::int64_t> reference_frames(const Chunk& window, int count);

/// Pictures that begin GOPs.
class GopStarts {
  public:
    /// Counts a picture, if it is one.
    void add(const encoder::CodedPicture& picture);
    void add(const GopStarts& others);

    /// Bytes per frame by which windows of the film that take `bytes` per frame take more than the film, since each
    /// begins with an I picture. 0 where none was counted.
    double surplus(const RenderJob& film, const std::vector<Chunk>& windows, double bytes) const;

  private:
    double bytes_ = 0;
    int count_ = 0;
};

}  // namespace render2mpeg::app
