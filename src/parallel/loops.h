#pragma once

#include <cstddef>
#include <functional>

/// The only place that knows TBB.
namespace render2mpeg::parallel {

/// Limits all loops of this process to `threads` threads while it lives; 0 takes all that the machine offers.
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    void* control_;
};

/// Threads that loops use now.
int thread_count();

/// Thrown by a loop that was asked to stop.
struct Stopped {};

/// While it lives, loops of its lane (lanes.h) end with Stopped at the next call of a body once `asked` returns true,
/// on any thread. The innermost of several counts; an empty function lets loops go on.
class StopWhen {
  public:
    explicit StopWhen(std::function<bool()> asked);
    ~StopWhen();
    StopWhen(const StopWhen&) = delete;
    StopWhen& operator=(const StopWhen&) = delete;

  private:
    std::function<bool()> asked_;
    const std::function<bool()>* before_;
};

/// Calls body(i) for every i in [0, count), in any order, on any thread. What body throws is thrown here; the order of
/// calls must not show in the result.
void for_each(std::size_t count, const std::function<void(std::size_t)>& body);

/// Calls body(first, last) for ranges of at most `grain` indices that cover [0, count). The ranges depend on count and
/// grain alone, never on the number of threads.
void for_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace render2mpeg::parallel
