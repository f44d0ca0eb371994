#pragma once
// The loop of a chunk: each frame from the scene to the stream.
#include <functional>

#include "app/job/render_job.h"
#include "app/loop/kept_frames.h"
#include "app/loop/observer.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "app/system/interrupt.h"

namespace render2mpeg::app {

/// Renders one chunk and, for a film, codes it. Returns whether it is whole: `frame_done` ends it after a frame by
/// returning false, `stops` within a frame, which is dropped. `observer` sees everything; the statistics grow by the
/// chunk's frames. `kept`: keeps them, and those that it has already are not lit again; null: nothing is kept.
bool render_chunk(const RenderJob& job, renderer::Renderer& renderer, const Chunk& chunk, LoopObserver& observer,
                  RunStatistics& statistics, const std::function<bool()>& frame_done,
                  const std::function<bool()>& stops = &InterruptGuard::requested, KeptFrames* kept = nullptr);

/// Renders a settled film chunk by chunk while `goes_on` says so. Returns whether it is whole.
bool render_through(const RenderJob& film, LoopObserver& observer, RunStatistics& statistics,
                    const std::function<bool()>& goes_on);

}  // namespace render2mpeg::app
