#pragma once

#include <utility>
#include <vector>

#include "app/job/render_job.h"
#include "app/loop/observer.h"
#include "encoder/bit_allocation.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Renders the film small and rough, codes it fast, and allocates bits by the result, one allocation per frame. Empty
/// after an interruption (docs/model/rate-control.md).
std::vector<encoder::BitAllocation> first_pass(const RenderJob& film, bool quiet);

/// Collects pictures of a rough coding with these settings.
class FirstPassCollector : public LoopObserver {
  public:
    explicit FirstPassCollector(encoder::Settings coding) : coding_(std::move(coding)) {}
    void begins(const Chunk&) override { starts_chunk_ = true; }
    void coded(const encoder::CodedPicture& picture) override {
        film_.push_back(encoder::first_pass_picture(coding_, picture, std::exchange(starts_chunk_, false)));
    }
    /// In coding order.
    const std::vector<encoder::FirstPassPicture>& film() const { return film_; }

  private:
    encoder::Settings coding_;
    std::vector<encoder::FirstPassPicture> film_;
    bool starts_chunk_ = true;
};

/// Fast coding with one quantiser (of MPEG-2, or its like), without rate or buffer.
encoder::Settings rough(encoder::Settings coding, double quantiser);

/// Expected MPEG-2 quantiser of this rate, for a first pass.
int usual_quantiser(const encoder::Settings& settings);

}  // namespace render2mpeg::app
