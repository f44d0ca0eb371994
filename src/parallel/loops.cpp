#include "parallel/loops.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

#include "core/error.h"
#include "parallel/loop_record.h"

namespace render2mpeg::parallel {
namespace {

std::atomic<const std::function<bool()>*> stop{nullptr};

void stop_where_asked() {
    const std::function<bool()>* asked = stop.load(std::memory_order_acquire);
    if (asked != nullptr && *asked && (*asked)()) throw Stopped{};
}

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

StopWhen::StopWhen(std::function<bool()> asked) : asked_(std::move(asked)), before_(stop.exchange(&asked_)) {}

StopWhen::~StopWhen() {
    stop = before_;
}

int thread_count() {
    return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

namespace {

void run(std::size_t count, const std::function<void(std::size_t)>& body) {
    tbb::parallel_for(
        std::size_t{0}, count,
        [&](std::size_t i) {
            stop_where_asked();
            body(i);
        },
        tbb::simple_partitioner{});
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
