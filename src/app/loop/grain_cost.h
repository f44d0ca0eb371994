#pragma once
// What film grain takes of a film's bits.
#include <vector>

#include "app/loop/observer.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "core/picture.h"

namespace render2mpeg::app {

/// Codes a film's first pictures by its quantiser with grain and without, both without motion that is given.
class GrainCost : public LoopObserver {
  public:
    /// Nothing is measured unless the chunk is the film's first and the film has grain and a quantiser: at a bit rate,
    /// grain takes no bits but quality.
    GrainCost(const Film& film, const Chunk& chunk);

    void lit(const LitFrame& frame) override { add(frame.picture); }
    void lit_before(const LitFrame& frame) override { add(frame.picture); }
    void read(const core::Picture& picture, const core::MotionField*) override { add(picture); }
    /// Adds what they come to. Its time counts as encoding.
    void measure(RunStatistics& statistics) const;

  private:
    void add(const core::Picture& picture);

    Film film_;
    bool wanted_;
    std::vector<core::Picture> pictures_;
};

}  // namespace render2mpeg::app
