#pragma once
// How much memory a run will take, and the limit on it.
#include <cstdint>

#include "app/loop/render_job.h"

namespace render2mpeg::app {

/// What rendering takes of memory, in bytes, by what takes it: reckoned before anything of it is allocated
/// (docs/measurements.md#memory).
struct MemoryNeed {
    std::uint64_t held = 0;       ///< by this process now: program, scene as it was read
    std::uint64_t triangles = 0;  ///< trees of rays, and what chooses anchors
    std::uint64_t textures = 0;   ///< with their smaller copies
    std::uint64_t decoding = 0;   ///< of the largest image, while it is read
    std::uint64_t lights = 0;     ///< light points and their trees
    std::uint64_t frames = 0;     ///< what is seen, lit and coded at a time

    std::uint64_t total() const { return held + triangles + textures + decoding + lights + frames; }
};

/// Reads the headers of all images. Throws core::Error.
MemoryNeed memory_need(const RenderJob& film);

/// Whether a render of such a need may decode its images side by side in `threads` threads, or one after the other to
/// keep the limit. Throws core::Error where even that is too much, and says what takes how much.
bool may_decode_at_once(const RenderJob& film, const MemoryNeed& need, std::uint64_t limit, int threads);

}  // namespace render2mpeg::app
