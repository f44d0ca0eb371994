#include "encoder/mpeg2/kernels.h"

#include "encoder/mpeg2/kernels_body.h"

namespace render2mpeg::encoder::mpeg2 {

#ifdef RENDER2MPEG_KERNELS_AVX2
extern const Kernels kernels_avx2;
#endif

KernelVariants kernel_variants() {
    KernelVariants variants{{&all_kernels, nullptr}, 1};
#ifdef RENDER2MPEG_KERNELS_AVX2
    if (__builtin_cpu_supports("avx2")) variants.variant[variants.count++] = &kernels_avx2;
#endif
    return variants;
}

const Kernels& kernels() {
    static const Kernels& best = []() -> const Kernels& {
        const KernelVariants variants = kernel_variants();
        return *variants.variant[variants.count - 1];
    }();
    return best;
}

}  // namespace render2mpeg::encoder::mpeg2
