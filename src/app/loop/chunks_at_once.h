#pragma once
// How many chunks of a film are made beside each other.
#include <string>

#include "app/loop/render_job.h"
#include "app/options/options.h"

namespace render2mpeg::app {

struct ChunksAtOnce {
    int count = 1;
    std::string reason;
};

/// One for every 16 threads, or as many as --chunks-at-once asks for; no more than --memory allows, else half of the
/// machine's memory where none are asked for; one where outputs go on from chunk to chunk. The film's bytes do not
/// depend on it. Images' headers are read where memory may be the limit.
ChunksAtOnce chunks_at_once(const RenderJob& film, const RenderOptions& options);

/// "4 chunks at once: 16 threads, 4 to a chunk; memory allows 9".
std::string text_of(const ChunksAtOnce& chosen);

}  // namespace render2mpeg::app
