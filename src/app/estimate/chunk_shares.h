#pragma once
// What share of a film's CPU time each chunk takes, and runs of chunks that take about as long as each other.
#include <cstddef>
#include <vector>

#include "app/job/render_job.h"
#include "app/options/film.h"

namespace render2mpeg::app {

/// Shares of each chunk in the CPU time of a film whose exposure is settled, without what every process begins with: by
/// small pictures of each chunk's shots where these take a small part of the time, else by numbers of frames.
std::vector<double> chunk_shares(const RenderJob& film, bool quiet);

/// Cuts chunks into `count` runs, no more than there are chunks, of which the longest is as short as can be.
std::vector<ChunkRange> balanced(const std::vector<double>& shares, std::size_t count);

}  // namespace render2mpeg::app
