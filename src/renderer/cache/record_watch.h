#pragma once
// Hold-out validation of the cache: points gathered all the same.
#include <cstddef>
#include <span>
#include <vector>

namespace render2mpeg::renderer {

/// A point that records served and that was gathered all the same.
struct WatchedPoint {
    float doubt = 0;  ///< what neighbours disagreed by over its tolerance, at a strictness of 1
    float miss = 0;   ///< what its light was off by, as it is noticed, over its tolerance
    float share = 1;  ///< of its frame's points that records serve
};

/// How strictly records must agree where a film's light is as it is: learnt from points that they served and that were
/// gathered as well. What a plane through neighbours cannot know is what lies between them: little in a nave, much
/// in a room full of small things (docs/fits/records.md).
class RecordWatch {
  public:
    /// Fewer say too little.
    static constexpr std::size_t least_points = 192;
    /// The newest are kept. chosen: docs/fits/records.md, "Hold-out validation".
    static constexpr std::size_t window = 2048;

    /// Nothing is known: records are trusted as in halls and naves.
    void forget() {
        points_.clear();
        next_ = 0;
        strictness_ = 1;
    }

    /// Takes what was watched in one frame, or part of one. Of nothing it learns nothing.
    void learn(std::span<const WatchedPoint> points);

    /// What multiplies disagreement, so that of all points at most the aimed share is served and off by more than
    /// it may.
    float strictness() const { return strictness_; }
    bool knows() const { return points_.size() >= least_points; }
    /// As many points as are ever kept.
    bool is_full() const { return points_.size() == window; }
    std::size_t bytes() const { return points_.capacity() * sizeof(WatchedPoint); }

  private:
    std::vector<WatchedPoint> points_;  ///< ring of the newest
    std::size_t next_ = 0;
    float strictness_ = 1;
};

}  // namespace render2mpeg::renderer
