#include "parallel/lanes.h"

#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "parallel/loops.h"

namespace render2mpeg::parallel {
namespace {

double seconds_of(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Keeps a core busy for this long of a thread's CPU time.
void work(double seconds) {
    const double end = seconds_of(CLOCK_THREAD_CPUTIME_ID) + seconds;
    while (seconds_of(CLOCK_THREAD_CPUTIME_ID) < end) {
    }
}

TEST(Lanes, RunAtTheSameTimeForAnyNumberOfThreads) {
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        std::barrier all(3);
        std::vector<std::atomic<int>> calls(3);
        run_lanes(3, [&](std::size_t lane) {
            all.arrive_and_wait();
            ++calls.at(lane);
        });
        for (const auto& n : calls) EXPECT_EQ(n, 1);
    }
}

TEST(Lanes, LoopsOfAllComeOutWhole) {
    for (const int threads : {1, 2, 3, 16}) {
        const ThreadLimit limit(threads);
        std::vector<std::atomic<int>> calls(4);
        run_lanes(4, [&](std::size_t lane) {
            for (int i = 0; i < 20; ++i)
                for_each(10, [&](std::size_t) { for_each(5, [&](std::size_t) { ++calls[lane]; }); });
        });
        for (const auto& n : calls) EXPECT_EQ(n, 20 * 10 * 5) << threads;
    }
}

TEST(Lanes, TogetherTakeNoMoreThreadsThanLoopsMay) {
    const ThreadLimit limit(3);
    std::atomic<int> running = 0, most = 0;
    run_lanes(2, [&](std::size_t) {
        for_each(150, [&](std::size_t) {
            const int now = ++running;
            for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
            }
            std::this_thread::sleep_for(std::chrono::microseconds(100));
            --running;
        });
    });
    EXPECT_LE(most, 3);
    EXPECT_GE(most, 2);
}

TEST(Lanes, ThrowWhatTheFirstOfThemThrowsOnceAllHaveEnded) {
    std::atomic<int> ended = 0;
    try {
        run_lanes(4, [&](std::size_t lane) {
            // The later one throws earlier.
            if (lane == 1) std::this_thread::sleep_for(std::chrono::milliseconds(20));
            ++ended;
            if (lane == 1 || lane == 3) throw std::runtime_error(std::to_string(lane));
        });
        FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "1");
    }
    EXPECT_EQ(ended, 4);
}

TEST(Lanes, OneIsTheCallingThread) {
    const auto caller = std::this_thread::get_id();
    run_lanes(1, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

TEST(Lanes, AreStoppedOneByOne) {
    std::vector<int> stopped(2);
    run_lanes(2, [&](std::size_t lane) {
        const StopWhen stop([lane] { return lane == 1; });
        try {
            for_each(100, [](std::size_t) {});
        } catch (const Stopped&) {
            stopped[lane] = 1;
        }
    });
    EXPECT_EQ(stopped, (std::vector<int>{0, 1}));
}

/// Bodies of a millisecond each, 40 in the first lane and 120 in the second.
TEST(Lanes, CountTheCpuTimeOfTheirOwnTasksOnAnyThread) {
    const ThreadLimit limit(4);
    std::vector<double> took(2);
    const double before = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
    run_lanes(2, [&](std::size_t lane) {
        const double begin = lane_seconds();
        for_each(lane == 0 ? 40 : 120, [](std::size_t) { work(0.001); });
        took[lane] = lane_seconds() - begin;
    });
    const double all = seconds_of(CLOCK_PROCESS_CPUTIME_ID) - before;
    EXPECT_GE(took[0], 0.040);
    EXPECT_GE(took[1], 0.120);
    EXPECT_LE(took[0] + took[1], all) << "nothing counts twice";
}

TEST(Lanes, OutsideOfThemTheTimeIsTheProcesss) {
    const double process = seconds_of(CLOCK_PROCESS_CPUTIME_ID), now = lane_seconds();
    EXPECT_GE(now, process);
    EXPECT_LE(now, seconds_of(CLOCK_PROCESS_CPUTIME_ID));
}

thread_local bool within = false;

TEST(ForEach, LetsNoOtherBodyBeginOnAThreadThatWaitsWithinOne) {
    const ThreadLimit limit(3);
    std::atomic<int> met = 0;
    for_each(60, [&](std::size_t) {
        met += within ? 1 : 0;
        within = true;
        for_each(3, [](std::size_t) { work(0.0003); });
        within = false;
    });
    EXPECT_EQ(met, 0);
}

}  // namespace
}  // namespace render2mpeg::parallel
