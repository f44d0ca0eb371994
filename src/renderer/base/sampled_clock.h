#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <ctime>
#include <utility>

namespace render2mpeg::renderer {

/// The CPU time of something that happens so often, and takes so little, that reading a clock each time would take
/// more: every 256th time is measured, less what the clock takes by itself, and stands for the others. Any number of
/// threads; the sum is no function of the input, and nothing may depend on it.
class SampledClock {
  public:
    template <class Work>
    auto time(Work&& work) {
        // chosen: a thread's clock takes some 0.3 us to read, which is 2 ns of each time (64..1024).
        constexpr unsigned period = 256;
        thread_local unsigned count = 0;
        if (++count % period != 0) return std::forward<Work>(work)();
        const std::int64_t before = now(), begin = now();
        auto result = std::forward<Work>(work)();
        nanoseconds_.fetch_add(period * ((now() - begin) - (begin - before)), std::memory_order_relaxed);
        return result;
    }
    double seconds() const {
        return 1e-9 * static_cast<double>(std::max(nanoseconds_.load(std::memory_order_relaxed), std::int64_t{0}));
    }

  private:
    static std::int64_t now() {
        timespec t{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return 1'000'000'000 * static_cast<std::int64_t>(t.tv_sec) + t.tv_nsec;
    }

    std::atomic<std::int64_t> nanoseconds_{0};
};

}  // namespace render2mpeg::renderer
