#pragma once

/// Before a function's definition: compiles it for several instruction sets and takes the widest that there is. For
/// loops over lanes or pixels; what such a function calls must be inlined (ALWAYS_INLINED) or have clones of its own.
/// Every operation rounds on its own (-ffp-contract=off) and lane by lane, so wider registers give the same bytes.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define RENDER2MPEG_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define RENDER2MPEG_CLONES
#endif

#define RENDER2MPEG_ALWAYS_INLINED __attribute__((always_inline)) inline

/// The standard's functions are not inlined into clones (g++ 12 takes only those that are always inlined), and a call
/// keeps a loop from becoming vector code.
namespace render2mpeg::core::inlined {

RENDER2MPEG_ALWAYS_INLINED float max(float a, float b) {
    return a < b ? b : a;
}
RENDER2MPEG_ALWAYS_INLINED float min(float a, float b) {
    return b < a ? b : a;
}
RENDER2MPEG_ALWAYS_INLINED float abs(float v) {
    return __builtin_fabsf(v);
}
RENDER2MPEG_ALWAYS_INLINED float sqrt(float v) {
    return __builtin_sqrtf(v);
}

}  // namespace render2mpeg::core::inlined
