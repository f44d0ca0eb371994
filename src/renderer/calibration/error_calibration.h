#pragma once
// The calibration factor of the cut's error, from audited pixels.
#include <cstddef>
#include <span>
#include <vector>

#include "core/archive.h"
#include "core/error.h"
#include "renderer/calibration/audited_pixel.h"

namespace render2mpeg::renderer {

/// How far a film's cuts err against what StoppingRule estimates: learnt from pixels that were gathered a second time
/// without clustering. The law of StoppingRule is that of the worst scenes; rooms err by a third of it.
///
/// For each audited pixel we compute the error scale at which its error would equal its tolerance (errors are
/// proportional to 1 / scale). The value is a high quantile of that over the newest pixels: what half the promised
/// share exceeds if the largest twentieth thins out as an exponential's tail does [Pickands1975], and at least so much
/// that a next pixel keeps its tolerance with the promised probability whatever the errors' distribution: split
/// conformal prediction [Lei2018, 2.2].
class ErrorCalibration {
  public:
    /// Fewer say too little of a hundredth.
    static constexpr std::size_t least_pixels = 128;

    /// No pixels at all: the law as it stands counts.
    void forget();

    /// Takes pixels of a frame that was lit with `error_scale`. Those stopped by the largest cut say nothing,
    /// nor do black ones: their light may come on.
    void learn(std::span<const AuditedPixel> pixels, float error_scale);

    /// Multiplier of the law, > 0; 1 while too few pixels are known. Changes in steps, and is held while estimates
    /// scatter about it: a film's cuts shall not change from frame to frame because of the audit's random choices.
    float value() const { return value_; }
    /// Lets go of what is held: what is known now counts.
    void settle();
    std::size_t pixels() const { return needed_.size(); }
    bool knows() const { return pixels() >= least_pixels; }

    template <class A>
    friend void archive(A& a, ErrorCalibration& c) {
        auto& [needed, next, holds, value] = c;
        a(needed, next, holds, value);
        if (next > needed.size()) throw core::Error("a calibration is damaged");
    }

  private:
    /// The quantile, before steps; 0 while too few pixels are known.
    float needed() const;

    std::vector<float> needed_;  ///< ring of the newest
    std::size_t next_ = 0;
    bool holds_ = false;
    float value_ = 1.0f;
};

}  // namespace render2mpeg::renderer
