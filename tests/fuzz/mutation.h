#pragma once

#include <cstdint>
#include <span>

#include "fuzz/targets.h"

namespace render2mpeg::fuzz {

/// One of the inputs of `corpus`, changed in one to eight places: bits, bytes and numbers, digits of numbers written
/// out, pieces cut, doubled, moved, or taken from another input. A function of the corpus, the seed and the number.
/// At most 64 KiB.
Bytes mutated(std::span<const Bytes> corpus, std::uint64_t seed, std::uint64_t number);

}  // namespace render2mpeg::fuzz
