#pragma once
// Limits of memory, and what the allocator keeps.
#include <cstdint>
#include <string>

namespace render2mpeg::app {

/// Bytes, from "8G", "1.5G", "900M" (powers of 1024). Throws core::Error.
std::uint64_t memory_from(const std::string& text);

/// Bytes of this process.
struct OwnMemory {
    std::uint64_t resident = 0, writable = 0;
    std::uint64_t peak = 0;  ///< resident at most, so far
};
OwnMemory own_memory();
/// Bytes of the machine.
std::uint64_t machine_memory();

/// Limits own memory to about `limit` bytes with this number of threads: more throws std::bad_alloc instead of
/// swapping.
void hold_to(std::uint64_t limit, int threads);

/// Throws core::Error where the stack is so small (`ulimit -s`) that libraries crash.
void expect_stack();

/// Lets the allocator keep freed memory: planes come and go with every frame, and page faults took a third of the eye's
/// time.
void keep_freed_memory();

}  // namespace render2mpeg::app
