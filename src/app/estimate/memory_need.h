#pragma once
// Memory that a film takes, before it is allocated.
#include <algorithm>
#include <cstdint>

#include "app/job/render_job.h"

namespace render2mpeg::app {

/// Estimated memory in bytes, before anything is allocated (docs/measurements.md#memory).
struct MemoryNeed {
    std::uint64_t held = 0;       ///< by this process now: program, scene as it was read
    std::uint64_t triangles = 0;  ///< trees of rays
    std::uint64_t textures = 0;   ///< with their smaller copies
    std::uint64_t decoding = 0;   ///< of the largest image, while it is read
    std::uint64_t volumes = 0;    ///< grids, and light within them
    std::uint64_t lights = 0;     ///< light points and their trees
    std::uint64_t frames = 0;     ///< visibility, light and pictures in flight
    std::uint64_t asked = 0;      ///< of frames, what rays ask: cells, records; at most, unless a sample told
    std::uint64_t moving = 0;     ///< of `triangles` and `volumes`, those of each chunk at work

    /// Before the first frame, and beside all of them.
    std::uint64_t scene() const { return held + triangles + textures + volumes + lights; }
    /// Images are read, `at_once` of them, before there are frames.
    std::uint64_t total(int at_once = 1) const {
        return scene() + std::max(frames + asked, decoding * static_cast<std::uint64_t>(at_once));
    }
    /// With rays that ask nothing.
    std::uint64_t least() const { return scene() + frames; }
    /// Of another chunk that is made beside the first.
    std::uint64_t of_chunk() const { return moving + lights + frames + asked; }
};

/// Reads the headers of all images. Throws core::Error.
MemoryNeed memory_need(const RenderJob& film);

/// A film's need by what a sample of it, the same in another size, was told and took: `taken` bytes at most, all that
/// the process held among them.
MemoryNeed by_sample(MemoryNeed film, const MemoryNeed& sample, std::uint64_t taken);

/// Whether `threads` may decode images at once within `limit`, else one after the other. Throws core::Error where even
/// that is too much.
bool may_decode_at_once(const RenderJob& film, const MemoryNeed& need, std::uint64_t limit, int threads);

}  // namespace render2mpeg::app
