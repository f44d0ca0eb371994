#include "core/isa.h"

#include <array>
#include <cstdlib>
#include <string>

#include "core/error.h"

namespace render2mpeg::core {
namespace {

constexpr std::array all{Isa::sse2, Isa::sse4_2, Isa::avx, Isa::avx2, Isa::avx512};

/// The highest level of the processor and its operating system.
Isa level_of_processor() {
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

/// The level with this name, of a processor that has those up to `highest`.
Isa level_named(const std::string& name, Isa highest) {
    for (const Isa isa : all) {
        if (name != name_of(isa)) continue;
        if (isa > highest)
            throw Error("instruction set " + name + ": this processor has " + name_of(highest) + " at most");
        return isa;
    }
    throw Error("instruction set " + name + ": unknown; there are sse2, sse4.2, avx, avx2, avx512");
}

}  // namespace

Isa detect_isa() {
    const char* most = std::getenv("RENDER2MPEG_ISA");
    return most == nullptr || *most == '\0' ? level_of_processor() : level_named(most, level_of_processor());
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
    return level_named(name, detect_isa());
}

}  // namespace render2mpeg::core
