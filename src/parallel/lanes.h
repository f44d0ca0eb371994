#pragma once

#include <cstddef>
#include <functional>

namespace render2mpeg::parallel {

/// Calls work(i) for every i in [0, count) at the same time, each on a thread of its own, its lane. All lanes share the
/// threads that loops may use, so that one's idle threads take up another's tasks; there are as many as thread_count(),
/// but at least one a lane. Of what lanes throw, the first lane's is thrown here, once all have ended. One lane is the
/// calling thread.
void run_lanes(std::size_t count, const std::function<void(std::size_t lane)>& work);

/// CPU seconds that the lane of the calling thread took so far, its loops' tasks on other threads among them; outside
/// of lanes, those of the process. Exact between loops. Work that libraries hand to threads by themselves counts for
/// the process alone.
double lane_seconds();

}  // namespace render2mpeg::parallel
