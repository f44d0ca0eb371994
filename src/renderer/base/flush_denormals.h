#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace render2mpeg::renderer {

/// Flushes denormals to zero while it lives, whatever the calling thread does otherwise: Embree is written for it, and
/// worker threads with another mode would give other bytes. Setting the mode takes some ten cycles; where it is set
/// already, as by whoever traces many packets, nearly none.
class FlushDenormals {
  public:
#if defined(__SSE2__)
    FlushDenormals() : before_(_mm_getcsr()) {
        if ((before_ & mode) != mode) _mm_setcsr(before_ | mode);
    }
    ~FlushDenormals() {
        if ((before_ & mode) != mode) _mm_setcsr(before_);
    }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
    static constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
    static constexpr unsigned mode = flush_to_zero | denormals_are_zero;
    unsigned before_;
#endif
};

}  // namespace render2mpeg::renderer
