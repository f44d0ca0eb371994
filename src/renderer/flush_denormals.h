#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace render2mpeg::renderer {

/// Flushes denormals to zero while it lives, whatever the calling thread does otherwise: Embree is written for it, and
/// worker threads with another mode would give other bytes. Some ten cycles.
class FlushDenormals {
  public:
#if defined(__SSE2__)
    FlushDenormals() : before_(_mm_getcsr()) {
        _mm_setcsr(before_ | flush_to_zero | denormals_are_zero);
    }
    ~FlushDenormals() {
        _mm_setcsr(before_);
    }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
    static constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
    unsigned before_;
#endif
};

}  // namespace render2mpeg::renderer
