#pragma once

#include <cstdint>
#include <string>

/// How much memory this process has, and may have.
namespace render2mpeg::app {

/// Bytes, from "8G", "1.5G", "900M" (powers of 1024). Throws core::Error.
std::uint64_t memory_from(const std::string& text);

/// Memory of this process in bytes: what is there, and what may be written to, there or not.
struct OwnMemory {
    std::uint64_t resident = 0, writable = 0;
};
OwnMemory own_memory();

/// Holds this process to about `limit` bytes of memory of its own from now on, with so many threads: what asks for more
/// gets std::bad_alloc, instead of making the machine swap.
void hold_to(std::uint64_t limit, int threads);

}  // namespace render2mpeg::app
