#pragma once
// What film grain takes of a film's bits.
#include <vector>

#include "app/loop/observer.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "core/picture.h"

namespace render2mpeg::app {

/// Pictures of a film by which its grain's bits are told: none unless it has grain and a quantiser, since grain takes
/// no bits but quality at a bit rate.
std::size_t grain_pictures(const Film& film);

/// Codes a film's first pictures by its quantiser with grain and without, both without motion that is given.
class GrainCost : public LoopObserver {
  public:
    /// Nothing is measured unless the chunk is the film's first.
    GrainCost(const Film& film, const Chunk& chunk);

    void lit(const LitFrame& frame) override { add(frame.picture); }
    void lit_before(const LitFrame& frame) override { add(frame.picture); }
    void read(const core::Picture& picture, const core::MotionField*) override { add(picture); }
    /// Adds what they come to. Its time counts as encoding.
    void measure(RunStatistics& statistics);

  private:
    void add(const core::Picture& picture);

    Film film_;
    std::size_t wanted_;  ///< pictures
    std::vector<core::Picture> pictures_;
};

}  // namespace render2mpeg::app
