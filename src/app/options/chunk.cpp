#include "app/options/chunk.h"

#include <algorithm>

#include "core/error.h"

namespace render2mpeg::app {

std::vector<Chunk> chunks_of(FrameRange frames, int gop) {
    EXPECTS(frames.first <= frames.last && gop >= 1);
    // chosen: about 60 frames, two seconds: short enough to lose little, long enough that starting anew costs little
    // (30..240).
    constexpr std::int64_t aim = 60;
    const std::int64_t length = std::max<std::int64_t>(1, (aim + gop / 2) / gop) * gop;

    std::vector<Chunk> chunks;
    for (std::int64_t first = frames.first; first <= frames.last; first += length)
        chunks.push_back({static_cast<int>(chunks.size()), first, std::min(first + length - 1, frames.last)});
    return chunks;
}

}  // namespace render2mpeg::app
