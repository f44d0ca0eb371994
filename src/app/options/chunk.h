#pragma once
// Chunks: runs of whole GOPs, the unit of resuming and of parallel rendering.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/options/options.h"

namespace render2mpeg::app {

/// A run of frames that shares state and depends on no other: the unit of resuming and of parallel rendering.
struct Chunk {
    int index = 0;
    std::int64_t first = 0, last = 0;  ///< frames, both inclusive

    std::int64_t frames() const { return last - first + 1; }
};

/// Chunks that follow each other, by their index.
struct ChunkRange {
    std::size_t first = 0, last = 0;  ///< both inclusive

    std::size_t count() const { return last - first + 1; }
};

/// Cuts a film into chunks of a whole number of closed GOPs on a fixed grid from its first frame. A function of the
/// film alone, never of threads or machines.
std::vector<Chunk> chunks_of(FrameRange frames, int gop);

}  // namespace render2mpeg::app
