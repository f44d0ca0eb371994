#pragma once
// Instruction-set levels, and the best of this machine.
#include <string>

namespace render2mpeg::core {

/// Instruction-set levels that change the bytes of a film (Embree's kernels differ by level), in rising order.
enum class Isa { sse2, sse4_2, avx, avx2, avx512 };

/// The highest level that this processor and its operating system offer, or a lower one that RENDER2MPEG_ISA names: a
/// processor without the levels above it. Throws Error where that names none, or one that is not there.
Isa detect_isa();

/// "sse2", "sse4.2", "avx", "avx2", "avx512": also the words Embree's `isa=` takes.
const char* name_of(Isa isa);

/// The level with this name. Throws Error for an unknown name and for a level that this processor lacks.
Isa isa_from(const std::string& name);

}  // namespace render2mpeg::core
