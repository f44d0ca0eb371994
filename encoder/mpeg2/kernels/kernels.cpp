#include "encoder/mpeg2/kernels/kernels.h"

#include "encoder/mpeg2/kernels/kernels_body.h"

namespace render2mpeg::encoder::mpeg2 {

#ifdef RENDER2MPEG_KERNELS_AVX2
extern const Kernels kernels_avx2;
#endif
#ifdef RENDER2MPEG_KERNELS_AVX512
extern const Kernels kernels_avx512;
#endif

KernelVariants kernel_variants() {
    KernelVariants variants{{&all_kernels}, 1};
#ifdef RENDER2MPEG_KERNELS_AVX2
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2"))
        variants.variant[variants.count++] = &kernels_avx2;
#endif
#ifdef RENDER2MPEG_KERNELS_AVX512
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2"))
        variants.variant[variants.count++] = &kernels_avx512;
#endif
    return variants;
}

namespace detail {

constinit const Kernels* kernels_in_use = &all_kernels;

}  // namespace detail

namespace {

[[maybe_unused]] const bool best_is_in_use = [] {
    const KernelVariants variants = kernel_variants();
    detail::kernels_in_use = variants.variant[variants.count - 1];
    return true;
}();

}  // namespace

}  // namespace render2mpeg::encoder::mpeg2
