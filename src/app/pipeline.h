#pragma once

#include <filesystem>
#include <functional>

#include "app/chunk.h"
#include "app/ledger.h"
#include "app/production.h"
#include "app/sink.h"
#include "app/work_folder.h"

namespace render2mpeg::app {

/// Where the products of a chunk go; what is null is not wanted.
struct Destination {
    ChunkFile* film = nullptr;
    Sink* sink = nullptr;
    const std::filesystem::path* layers = nullptr;  ///< folder of the multilayer files
};

/// Renders and codes one chunk (DESIGN.md, "The loop"): the only place that knows scene, renderer, eye and encoder.
/// Calls `frame_done` after every frame and stops early, leaving complete pictures, when it returns false. The ledger
/// grows by the chunk's frames; it is returned whether the chunk is whole.
bool render_chunk(const Production& film, renderer::Renderer& renderer, const Chunk& chunk,
                  const Destination& destination, Ledger& ledger, const std::function<bool()>& frame_done);

}  // namespace render2mpeg::app
