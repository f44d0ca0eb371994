// The kernels compiled for AVX2; nothing else may be in this file. See kernels_body.h.
#ifdef RENDER2MPEG_KERNELS_AVX2
#include "encoder/mpeg2/kernels/kernels_body.h"

namespace render2mpeg::encoder::mpeg2 {

extern const Kernels kernels_avx2;
const Kernels kernels_avx2 = all_kernels;

}  // namespace render2mpeg::encoder::mpeg2
#endif
