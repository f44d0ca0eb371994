// The kernels compiled for AVX-512; nothing else may be in this file. See kernels_body.h.
#ifdef RENDER2MPEG_KERNELS_AVX512
#include "encoder/mpeg2/kernels/kernels_body.h"

namespace render2mpeg::encoder::mpeg2 {

extern const Kernels kernels_avx512;
const Kernels kernels_avx512 = all_kernels;

}  // namespace render2mpeg::encoder::mpeg2
#endif
