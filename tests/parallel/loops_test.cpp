#include "parallel/loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"

namespace render2mpeg::parallel {
namespace {

using Range = std::pair<std::size_t, std::size_t>;

std::vector<Range> ranges_of(std::size_t count, std::size_t grain) {
    std::mutex mutex;
    std::vector<Range> ranges;
    for_ranges(count, grain, [&](std::size_t first, std::size_t last) {
        const std::lock_guard lock(mutex);
        ranges.emplace_back(first, last);
    });
    std::sort(ranges.begin(), ranges.end());
    return ranges;
}

TEST(ForEach, CallsEveryIndexOnce) {
    for (const std::size_t count : {0u, 1u, 2u, 17u, 10000u}) {
        std::vector<std::atomic<int>> calls(count);
        for_each(count, [&](std::size_t i) { ++calls.at(i); });
        for (const auto& n : calls) EXPECT_EQ(n, 1);
    }
}

TEST(ForEach, ThrowsWhatItsBodyThrows) {
    for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        try {
            for_each(1000, [](std::size_t i) {
                if (i == 700) throw core::Error("reading", "x.png", "truncated");
            });
            FAIL() << "nothing was thrown";
        } catch (const core::Error& error) {
            EXPECT_STREQ(error.what(), "reading x.png: truncated");
        }
    }
}

TEST(ForEach, WorksInsideItself) {
    std::atomic<int> calls = 0;
    for_each(20, [&](std::size_t) { for_each(30, [&](std::size_t) { ++calls; }); });
    EXPECT_EQ(calls, 600);
}

TEST(ForRanges, CoverEveryIndexOnceInPiecesOfAtMostTheGrain) {
    for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 1000u})
        for (const std::size_t grain : {1u, 8u, 2000u}) {
            std::size_t expected = 0;
            for (const auto& [first, last] : ranges_of(count, grain)) {
                EXPECT_EQ(first, expected);
                EXPECT_GT(last, first);
                EXPECT_LE(last - first, grain);
                expected = last;
            }
            EXPECT_EQ(expected, count);
        }
}

TEST(ForRanges, DoNotDependOnTheNumberOfThreads) {
    std::vector<std::vector<Range>> found;
    for (const int threads : {1, 2, 3, 8}) {
        const ThreadLimit limit(threads);
        found.push_back(ranges_of(12345, 64));
    }
    for (const auto& ranges : found) EXPECT_EQ(ranges, found.front());
}

TEST(ForRanges, RefuseAGrainOfZero) {
    EXPECT_THROW(for_ranges(10, 0, [](std::size_t, std::size_t) {}), core::ContractViolation);
}

TEST(ThreadLimit, OfOneRunsEverythingOnTheCallersThread) {
    const ThreadLimit limit(1);
    EXPECT_EQ(thread_count(), 1);
    const auto caller = std::this_thread::get_id();
    for_each(200, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

TEST(StopWhen, EndsLoopsWhereItIsAsked) {
    std::atomic<int> calls = 0;
    const auto count = [&](std::size_t) { ++calls; };
    {
        const StopWhen stop([&] { return calls >= 10; });
        EXPECT_THROW(for_each(100'000, count), Stopped);
        EXPECT_LT(calls, 10 + 10 * thread_count());
        const StopWhen never({});
        EXPECT_NO_THROW(for_each(100, count)) << "the innermost counts";
    }
    EXPECT_NO_THROW(for_each(100, count));
}

TEST(ThreadLimit, IsNeverExceeded) {
    const ThreadLimit limit(2);
    std::atomic<int> running = 0, most = 0;
    for_each(300, [&](std::size_t) {
        const int now = ++running;
        for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
        }
        std::this_thread::sleep_for(std::chrono::microseconds(100));
        --running;
    });
    EXPECT_LE(most, 2);
    EXPECT_GE(most, 1);
}

TEST(ThreadLimit, EndsWithItsLife) {
    const int before = thread_count();
    {
        const ThreadLimit limit(1);
        EXPECT_EQ(thread_count(), 1);
    }
    EXPECT_EQ(thread_count(), before);
}

TEST(ThreadLimit, OfZeroTakesTheMachine) {
    const ThreadLimit limit(0);
    EXPECT_GE(thread_count(), 1);
    EXPECT_LE(thread_count(), static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

TEST(ThreadLimit, RefusesNegativeNumbers) {
    EXPECT_THROW(ThreadLimit(-1), core::ContractViolation);
}

}  // namespace
}  // namespace render2mpeg::parallel
