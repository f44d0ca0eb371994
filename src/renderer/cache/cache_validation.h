#pragma once
// Learns the cache error scale from points that records served and that were gathered as well.
#include <cstddef>
#include <span>
#include <vector>

namespace render2mpeg::renderer {

/// A point that records served and that was gathered all the same.
struct HeldOutPoint {
    float estimate = 0;  ///< disagreement of neighbours over its tolerance, at a cache_error_scale of 1
    float error = 0;     ///< error of its light, as it is noticed, over its tolerance
    float share = 1;     ///< of its frame's points that records serve
};

/// How strictly a film's records must agree: learnt from points that they served and that were gathered as well.
/// Interpolation misses detail between records: little in a nave, much in a room full of small things
/// (docs/measurements.md#irradiance-cache).
class CacheValidation {
  public:
    /// Fewer say too little.
    static constexpr std::size_t least_points = 192;
    /// The newest are kept. chosen: docs/measurements.md#irradiance-cache, "Hold-out validation".
    static constexpr std::size_t window = 2048;

    /// Nothing is known: records are trusted as in halls and naves.
    void forget() {
        points_.clear();
        next_ = 0;
        cache_error_scale_ = 1;
    }

    /// Takes the held-out points of one frame, or of part of one. None change nothing.
    void learn(std::span<const HeldOutPoint> points);

    /// Multiplier of disagreement: at most the aimed share of all points is served with an error over its tolerance.
    float cache_error_scale() const { return cache_error_scale_; }
    bool knows() const { return points_.size() >= least_points; }
    /// As many points as are ever kept.
    bool is_full() const { return points_.size() == window; }
    std::size_t bytes() const { return points_.capacity() * sizeof(HeldOutPoint); }

  private:
    std::vector<HeldOutPoint> points_;  ///< ring of the newest
    std::size_t next_ = 0;
    float cache_error_scale_ = 1;
};

}  // namespace render2mpeg::renderer
