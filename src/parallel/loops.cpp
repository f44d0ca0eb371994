#include "parallel/loops.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

#include "core/error.h"
#include "parallel/fork.h"
#include "parallel/lane.h"
#include "parallel/loop_record.h"

namespace render2mpeg::parallel {
namespace {

void stop_where_asked(const Lane& lane) {
    const std::function<bool()>* asked = lane.stop.load(std::memory_order_acquire);
    if (asked != nullptr && *asked && (*asked)()) throw Stopped{};
}

/// Bodies of loops that this thread is within.
thread_local int depth = 0;

struct Deeper {
    Deeper() { ++depth; }
    ~Deeper() { --depth; }
    Deeper(const Deeper&) = delete;
    Deeper& operator=(const Deeper&) = delete;
};

}  // namespace

ThreadLimit::ThreadLimit(int threads) : control_(nullptr) {
    EXPECTS(threads >= 0);
    const auto count =
        threads > 0 ? static_cast<std::size_t>(threads) : std::max<std::size_t>(1, std::thread::hardware_concurrency());
    control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, count);
}

ThreadLimit::~ThreadLimit() {
    delete static_cast<tbb::global_control*>(control_);
}

StopWhen::StopWhen(std::function<bool()> asked)
    : asked_(std::move(asked)), before_(present_lane().stop.exchange(&asked_)) {}

StopWhen::~StopWhen() {
    present_lane().stop = before_;
}

int thread_count() {
    return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

namespace {

void run(std::size_t count, const std::function<void(std::size_t)>& body) {
    Lane& lane = present_lane();
    Fork fork;
    const auto loop = [&] {
        tbb::parallel_for(
            std::size_t{0}, count,
            [&](std::size_t i) {
                const Fork::Prong prong(fork);
                const InLane in(lane);
                const Deeper deeper;
                stop_where_asked(lane);
                body(i);
            },
            tbb::simple_partitioner{});
    };
    // Who waits within a body takes up no other, which would find that one's locks and thread_local variables.
    if (depth > 0)
        tbb::this_task_arena::isolate(loop);
    else
        loop();
}

}  // namespace

void for_each(std::size_t count, const std::function<void(std::size_t)>& body, const char* file, int line) {
    if (is_recorded())
        record(
            count, file, line, [&](const std::function<void(std::size_t)>& timed) { run(count, timed); }, body);
    else
        run(count, body);
}

void for_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body,
                const char* file, int line) {
    EXPECTS(grain > 0);
    for_each((count + grain - 1) / grain, [&](std::size_t i) { body(i * grain, std::min(count, (i + 1) * grain)); },
             file, line);
}

}  // namespace render2mpeg::parallel
