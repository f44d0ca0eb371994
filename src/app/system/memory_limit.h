#pragma once
#include <cstdint>
#include <string>

#pragma once
// Tunes the allocator to keep freed memory.

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

/// Lets this process keep memory that it has freed. Planes of pictures come and go with every frame; given back to the
/// system each time, every 4 KB of them cost a fault when they are wanted again: a third of the eye's time. For
/// programs, at their start.
void keep_freed_memory();

}  // namespace render2mpeg::app
