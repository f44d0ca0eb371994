#pragma once
// Quantisers that bring finished frames to a bit rate.
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "app/commands/encode_job.h"
#include "encoder/bit_allocation.h"

namespace render2mpeg::app {

/// Allocates the bits of chunks by a first pass, which is repeated where its quantiser was far off. Empty after an
/// interruption.
std::vector<encoder::BitAllocation> first_pass(EncodeJob& job, std::span<const Chunk> chunks, bool quiet);

/// Codes a film of another codec than MPEG-2 at its bit rate, with the job's allocations: one quantiser, the same for
/// all pictures. `code` codes the whole film anew and tells its bits, or none after an interruption; the last time
/// counts. Returns whether nobody interrupted.
bool code_at_rate(EncodeJob& job, const std::function<std::optional<double>()>& code, bool quiet,
                  RunStatistics& statistics);

/// Allocates the bits of one pass from a chunk on: some chunks are there to be looked through before they are coded,
/// and share their bits. False after an interruption.
bool look_through(EncodeJob& job, const Chunk& first, bool quiet, RunStatistics& statistics);

}  // namespace render2mpeg::app
