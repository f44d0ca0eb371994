#pragma once
// Measures how loud a sound is, with libebur128.
#include <ebur128.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "encoder/av/module/ffmpeg.h"
#include "encoder/av/sound.h"

namespace render2mpeg::av {

/// Loudness of samples as they come. [BS1770]
class LoudnessMeter {
  public:
    /// `rate` in samples per second. Throws std::bad_alloc.
    LoudnessMeter(int channels, int rate);

    /// The first `samples` of a frame, which is of a format that audio encoders take.
    void add(const AVFrame& frame, int samples);
    /// None: too quiet for a loudness, or too short.
    std::optional<Loudness> loudness() const;

  private:
    struct Freed {
        void operator()(ebur128_state* state) const { ebur128_destroy(&state); }
    };
    template <class Sample>
    void interleave(const AVFrame& frame, bool is_planar, float full_scale);

    int channels_;
    std::unique_ptr<ebur128_state, Freed> state_;
    std::vector<float> interleaved_;
};

}  // namespace render2mpeg::av
