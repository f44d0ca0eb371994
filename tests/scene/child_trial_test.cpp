#include "scene/isolation/child_trial.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/error.h"
#include "scene/load.h"
#include "support/program.h"

namespace render2mpeg::scene {
namespace {

/// What try_in_child says of `reading`; empty when it went well.
std::string complaint_of(const std::function<void(const TakeTurns&)>& reading) {
    const support::Folder folder;
    std::ofstream(folder / "scene.xyz") << "ten bytes.";
    try {
        try_in_child(folder / "scene.xyz", reading);
        return {};
    } catch (const core::Error& error) {
        return error.what();
    }
}

TEST(ChildTrial, SaysNothingOfWhatGoesWell) {
    int calls = 0;
    EXPECT_EQ(complaint_of([&](const TakeTurns&) { ++calls; }), "");
    EXPECT_EQ(calls, 0) << "the child's memory is its own";
}

TEST(ChildTrial, PassesOnWhatTheReaderRefuses) {
    EXPECT_EQ(complaint_of([](const TakeTurns&) { throw core::Error("reading", "a.obj", "no such mesh"); }),
              "reading a.obj: no such mesh");
}

TEST(ChildTrial, SurvivesACrash) {
    EXPECT_NE(complaint_of([](const TakeTurns&) { std::abort(); }).find("crashed"), std::string::npos);
    EXPECT_NE(complaint_of([](const TakeTurns&) { throw 3; }).find("crashed"), std::string::npos);
}

TEST(ChildTrial, TellsDeathsOfOurOwnCodeFromRefusals) {
    const support::Folder folder;
    std::ofstream(folder / "scene.xyz") << "ten bytes.";
    const auto fault_of = [&](const std::function<void()>& ours) -> std::string {
        try {
            try_in_child(folder / "scene.xyz", [&](const TakeTurns& take_turns) {
                take_turns(Turn::ours);
                ours();
            });
        } catch (const std::logic_error& fault) {
            return fault.what();
        }
        return {};
    };
    for (const std::function<void()>& death :
         {std::function<void()>([] { std::abort(); }), std::function<void()>([] { throw 3; }),
          // As sanitizers and libraries end a process.
          std::function<void()>([] { _exit(1); }), std::function<void()>([] { EXPECTS(2 > 3); })})
        EXPECT_NE(fault_of(death).find("render2mpeg itself crashes"), std::string::npos) << fault_of(death);
    EXPECT_NE(fault_of([] { throw std::bad_alloc(); }).find("itself takes more memory"), std::string::npos);
    EXPECT_NE(fault_of([] { std::raise(SIGXCPU); }).find("itself takes more time"), std::string::npos);
    // What our own code refuses is the file's fault.
    EXPECT_THROW(fault_of([] { throw core::Error("no light"); }), core::Error);
    EXPECT_NE(complaint_of([](const TakeTurns&) { _exit(1); }).find("its parser crashed"), std::string::npos);
    EXPECT_NE(complaint_of([](const TakeTurns& take_turns) {
                  take_turns(Turn::ours);
                  take_turns(Turn::parser);
                  std::abort();
              }).find("its parser crashed"),
              std::string::npos);
}

TEST(ChildTrial, LeavesInterruptsToItsParent) {
    // As a terminal sends them to all processes of a command.
    EXPECT_EQ(complaint_of([](const TakeTurns&) {
                  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::raise(signal);
              }),
              "");
}

TEST(ChildTrial, DoesNotSayThatWhatWasKilledIsDamaged) {
    for (const Turn turn : {Turn::parser, Turn::ours})
        EXPECT_EQ(complaint_of([&](const TakeTurns& take_turns) {
                      take_turns(turn);
                      std::raise(SIGKILL);
                  }).find("was killed (out of memory?)") == std::string::npos,
                  false);
}

TEST(ChildTrial, EndsWithItsParent) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t parent = fork();
    if (parent == 0) {
        const ChildTrial endless("file", {std::uintmax_t{1} << 30, 0, 0}, [&](const TakeTurns&) -> std::string {
            const pid_t child = getpid();
            if (::write(ends[1], &child, sizeof child) != sizeof child) return {};
            for (;;) pause();
        });
        pid_t child = 0;
        const bool begun = ::read(ends[0], &child, sizeof child) == sizeof child &&
                           ::write(ends[1], &child, sizeof child) == sizeof child;
        _exit(begun ? 0 : 1);  // without a destructor, as where it is killed
    }
    close(ends[1]);
    int status = -1;
    waitpid(parent, &status, 0);
    ASSERT_EQ(status, 0);
    pid_t child = 0;
    ASSERT_EQ(::read(ends[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
    // The pipe ends when nobody is left to write to it.
    pollfd end{ends[0], POLLIN, 0};
    constexpr int long_enough = 60'000;
    const bool ended = poll(&end, 1, long_enough) == 1;
    EXPECT_TRUE(ended);
    if (!ended) kill(child, SIGKILL);
    close(ends[0]);
}

TEST(ChildTrial, TellsWhatWasReadHoweverLongItIs) {
    const TrialLimits limits = limits_for(0);
    const std::string text(300'000, 'x');
    ChildTrial one("one", limits, [&](const TakeTurns&) { return text; });
    ChildTrial two("two", limits, [](const TakeTurns&) -> std::string { std::abort(); });
    ChildTrial three("three", limits, [](const TakeTurns&) -> std::string { throw core::Error("no image"); });
    // One that nobody waits for is ended.
    const ChildTrial endless("four", limits, [](const TakeTurns&) -> std::string {
        for (;;) pause();
    });
    EXPECT_TRUE(three.told().refused);
    EXPECT_THROW(two.told(), core::Error);
    const ChildTrial::Told told = one.told();
    EXPECT_FALSE(told.refused);
    EXPECT_TRUE(told.text == text);
}

TEST(ChildTrialSlow, EndsAParserThatNeverDoes) {
    const auto endless = [](const TakeTurns&) {
        for (volatile bool on = true; on;) continue;
    };
    EXPECT_NE(complaint_of(endless).find("more time than a file of its size can need"), std::string::npos);
}

TEST(ChildTrial, InheritsNoLockOfAThreadThatWorks) {
    // As threads do that libraries start.
    std::mutex lock;
    std::atomic<bool> locked = false;
    const std::jthread other([&](const std::stop_token& over) {
        {
            const std::lock_guard guard(lock);
            locked = true;
            const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
            while (std::chrono::steady_clock::now() < end) continue;
        }
        while (!over.stop_requested()) usleep(1000);
    });
    while (!locked) usleep(100);
    ChildTrial trial("scene.xyz", {std::uintmax_t{1} << 30, 0, 5}, [&](const TakeTurns&) {
        const std::lock_guard guard(lock);
        return std::string("has it");
    });
    EXPECT_EQ(trial.told().text, "has it");
}

TEST(ChildTrial, BeginsWhileOtherThreadsEnd) {
    // As a pool's do that is let go: listed as threads of this process, and gone when they are looked at.
    const std::jthread others([](const std::stop_token& over) {
        while (!over.stop_requested()) {
            std::vector<std::jthread> ended;
            for (int i = 0; i < 4; ++i) ended.emplace_back([] { usleep(20); });
        }
    });
    for (int i = 0; i < 20; ++i) {
        ChildTrial trial("scene.xyz", {std::uintmax_t{1} << 30, 0, 5}, [](const TakeTurns&) { return "read"; });
        EXPECT_EQ(trial.told().text, "read");
    }
}

#ifndef RENDER2MPEG_SANITIZED
TEST(ChildTrial, RefusesFilesThatTakeAllMemory) {
    // Room alone, which costs nothing until it is written to.
    const auto hoard = [](const TakeTurns&) {
        std::vector<std::unique_ptr<char[]>> blocks;
        for (int i = 0; i < 64; ++i) blocks.emplace_back(new char[std::size_t{1} << 28]);
    };
    EXPECT_NE(complaint_of(hoard).find("more memory"), std::string::npos);
    // As libraries in C do, each with words of its own.
    const auto tries_to = [](const TakeTurns&) {
        if (std::malloc(std::size_t{1} << 34) == nullptr) throw core::Error("reading", "scene.xyz", "bad header");
    };
    EXPECT_NE(complaint_of(tries_to).find("more memory"), std::string::npos) << complaint_of(tries_to);
}

TEST(ChildTrial, DoesNotSayThatAFileIsDamagedWhereTheUserAllowsLittleMemory) {
    const auto take_half_a_gibibyte = [](const TakeTurns&) {
        const std::unique_ptr<char[]> block(new char[std::size_t{1} << 29]);
        static_cast<volatile char*>(block.get())[0] = 1;
    };
    EXPECT_EQ(complaint_of(take_half_a_gibibyte), "") << "the limit for any file";
    for (const int resource : {RLIMIT_AS, RLIMIT_DATA}) {
        rlimit before{};
        ASSERT_EQ(getrlimit(static_cast<__rlimit_resource>(resource), &before), 0);
        rlimit little = before;
        little.rlim_cur = std::uintmax_t{400} << 20;
        ASSERT_EQ(setrlimit(static_cast<__rlimit_resource>(resource), &little), 0);
        const std::string complaint = complaint_of(take_half_a_gibibyte);
        setrlimit(static_cast<__rlimit_resource>(resource), &before);
        EXPECT_NE(complaint.find("more memory than this process may have (--memory, ulimit)"), std::string::npos)
            << complaint;
    }
}

TEST(ChildTrial, APlyFileThatCountsToABillionIsRefused) {
    const support::Folder folder;
    std::ofstream(folder / "count.ply")
        << "ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1000000000\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 "
           "2\n";
    try {
        load(folder / "count.ply");
        ADD_FAILURE() << "accepted";
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("more memory than a file of its size can need"), std::string::npos)
            << error.what();
    }
}
#endif

}  // namespace
}  // namespace render2mpeg::scene
