#pragma once
// The loop of a chunk: each frame from the scene to the stream.
#include <functional>

#include "app/loop/observer.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "app/system/interrupt.h"

namespace render2mpeg::app {

/// Renders one chunk and, where the job is a film, codes it: the only place that knows scene, renderer, visibility
/// model and encoder. Calls `frame_done` after every frame and stops early, leaving complete pictures, when it returns
/// false, or in the midst of a frame, which is given up, where `stops` returns true. `observer` gets all that is made.
/// The statistics grow by the chunk's frames; it is returned whether the chunk is whole.
bool render_chunk(const RenderJob& job, renderer::Renderer& renderer, const Chunk& chunk, LoopObserver& observer,
                  RunStatistics& statistics, const std::function<bool()>& frame_done,
                  const std::function<bool()>& stops = &InterruptGuard::requested);

}  // namespace render2mpeg::app
