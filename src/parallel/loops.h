#pragma once

#include <cstddef>
#include <filesystem>
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

/// While it lives, CPU seconds are taken of every task of the loops that this thread begins, and of the thread itself
/// between them; of loops within tasks as part of these. With one thread this tells how long any number would take
/// (bench/scaling). One at a time. Writes them to `file` in the end, a line for each place of the sources: file, line,
/// loops, tasks, seconds of tasks, of each loop's longest task, of the thread before the loop, and of the loop as
/// `recorded_threads` threads would take it, one task after another. A last line has the seconds after the last loop.
class LoopRecord {
  public:
    explicit LoopRecord(std::filesystem::path file);
    ~LoopRecord();
    LoopRecord(const LoopRecord&) = delete;
    LoopRecord& operator=(const LoopRecord&) = delete;
};
inline constexpr int recorded_threads[] = {2, 4, 8, 16, 32, 64};

/// Calls body(i) for every i in [0, count), in any order, on any thread. What body throws is thrown here; the order of
/// calls must not show in the result. `file` and `line` are of the call, for LoopRecord.
void for_each(std::size_t count, const std::function<void(std::size_t)>& body, const char* file = __builtin_FILE(),
              int line = __builtin_LINE());

/// Calls body(first, last) for ranges of at most `grain` indices that cover [0, count). The ranges depend on count and
/// grain alone, never on the number of threads.
void for_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body,
                const char* file = __builtin_FILE(), int line = __builtin_LINE());

}  // namespace render2mpeg::parallel
