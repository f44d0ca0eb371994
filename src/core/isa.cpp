#include "core/isa.h"

#include <array>

#include "core/error.h"

namespace render2mpeg::core {
namespace {

constexpr std::array all{Isa::sse2, Isa::sse4_2, Isa::avx, Isa::avx2, Isa::avx512};

}  // namespace

Isa detect_isa() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512cd") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
        return Isa::avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return Isa::avx2;
    if (__builtin_cpu_supports("avx")) return Isa::avx;
    if (__builtin_cpu_supports("sse4.2")) return Isa::sse4_2;
#endif
    return Isa::sse2;
}

const char* name_of(Isa isa) {
    switch (isa) {
        case Isa::sse2:
            return "sse2";
        case Isa::sse4_2:
            return "sse4.2";
        case Isa::avx:
            return "avx";
        case Isa::avx2:
            return "avx2";
        case Isa::avx512:
            return "avx512";
    }
    return "?";
}

Isa isa_from(const std::string& name) {
    for (const Isa isa : all) {
        if (name != name_of(isa)) continue;
        if (isa > detect_isa())
            throw Error("instruction set " + name + ": this processor has " + name_of(detect_isa()) + " at most");
        return isa;
    }
    throw Error("instruction set " + name + ": unknown; there are sse2, sse4.2, avx, avx2, avx512");
}

}  // namespace render2mpeg::core
