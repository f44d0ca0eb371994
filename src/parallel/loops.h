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

/// Calls body(i) for every i in [0, count), in any order, on any thread. What body throws is thrown here; the order of
/// calls must not show in the result.
void for_each(std::size_t count, const std::function<void(std::size_t)>& body);

/// Calls body(first, last) for ranges of at most `grain` indices that cover [0, count). The ranges depend on count and
/// grain alone, never on the number of threads.
void for_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace render2mpeg::parallel
