#include "parallel/lanes.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <ctime>
#include <exception>
#include <thread>
#include <vector>

#include "parallel/lane.h"
#include "parallel/loops.h"

namespace render2mpeg::parallel {
namespace {

std::int64_t nanoseconds_of(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return 1'000'000'000 * static_cast<std::int64_t>(t.tv_sec) + t.tv_nsec;
}

Lane process;

struct Present {
    Lane* lane = &process;
    std::int64_t since = 0;  ///< its CPU time when it came to the lane
};
thread_local Present present;

/// Counts what the thread did for its lane, and turns to another, or to the same.
void turn_to(Lane& lane) {
    const std::int64_t now = nanoseconds_of(CLOCK_THREAD_CPUTIME_ID);
    present.lane->nanoseconds.fetch_add(now - present.since, std::memory_order_relaxed);
    present = {&lane, now};
}

}  // namespace

Lane& present_lane() {
    return *present.lane;
}

InLane::InLane(Lane& lane) : before_(*present.lane) {
    if (&lane != &before_) turn_to(lane);
}

InLane::~InLane() {
    if (present.lane != &before_) turn_to(before_);
}

double lane_seconds() {
    if (present.lane == &process) return 1e-9 * static_cast<double>(nanoseconds_of(CLOCK_PROCESS_CPUTIME_ID));
    turn_to(*present.lane);
    return 1e-9 * static_cast<double>(present.lane->nanoseconds.load(std::memory_order_relaxed));
}

void run_lanes(std::size_t count, const std::function<void(std::size_t)>& work) {
    if (count == 1) return work(0);
    std::vector<Lane> lanes(count);
    std::vector<std::exception_ptr> thrown(count);
    const auto seats = static_cast<int>(count);
    tbb::task_arena arena(std::max(thread_count(), seats), static_cast<unsigned>(seats));
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < count; ++i)
            threads.emplace_back([&, i] {
                const InLane in(lanes[i]);
                try {
                    arena.execute([&] { work(i); });
                } catch (...) {
                    thrown[i] = std::current_exception();
                }
            });
    }
    for (const std::exception_ptr& failure : thrown)
        if (failure) std::rethrow_exception(failure);
}

}  // namespace render2mpeg::parallel
