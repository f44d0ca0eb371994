#pragma once
// Film of finished frames, and the coding of its chunks.
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/loop/frame_source.h"
#include "app/loop/motion_source.h"
#include "app/loop/observer.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "app/system/progress.h"
#include "encoder/types.h"

namespace render2mpeg::app {

struct EncodeJob {
    std::unique_ptr<FrameSource> frames;
    std::unique_ptr<MotionSource> motion;  ///< null: not given
    Film film;
    std::vector<encoder::BitAllocation> allocations;  ///< one per frame, where there is a first pass

    /// Whether its frames and their motion can be read again.
    bool is_there() const { return !frames->is_open_ended() && (motion == nullptr || !motion->is_read_once()); }
};

/// The first chunk, or the one after `before`; none behind the last. An open-ended film has chunks of usual length.
std::optional<Chunk> chunk_after(const Film& film, const std::optional<Chunk>& before);

/// Codes one chunk, also where it ends early. `film`: the job's, or as it is tried. `allocations`: of the film's
/// frames; empty: there are none. Returns whether it is whole.
bool encode_chunk(EncodeJob& job, const Film& film, const Chunk& chunk,
                  std::span<const encoder::BitAllocation> allocations, LoopObserver& observer,
                  RunStatistics& statistics, Progress& progress);

}  // namespace render2mpeg::app
