#pragma once
// What the pictures that begin GOPs take of a sample, and by how much that is more than in the film.
#include <vector>

#include "app/loop/render_job.h"
#include "app/options/chunk.h"
#include "encoder/types.h"

namespace render2mpeg::app {

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
