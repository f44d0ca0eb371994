#include "scene/isolation/probe.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "scene/load.h"
#include "support/program.h"

namespace render2mpeg::scene {
namespace {

using Words = std::vector<std::string>;

const std::string readings = (support::binary_folder() / "probe_readings").string();

/// Lets probes be the program probe_readings.cpp.
class ProbeOf : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        setenv("RENDER2MPEG_PROGRAM", readings.c_str(), 1);
        // Heaps of threads that have ended take address space, which a test limits.
        mallopt(M_ARENA_MAX, 1);
    }
    static void TearDownTestSuite() { unsetenv("RENDER2MPEG_PROGRAM"); }
};
using Probes = ProbeOf;
using ProbesSlow = ProbeOf;

/// What is said of a reading; empty when it went well.
std::string complaint_of(const Words& words) {
    const ProbeLimits limits = limits_for(std::uintmax_t{10});
    Words all{"read"};
    all.insert(all.end(), words.begin(), words.end());
    try {
        const std::string text = text_of(Probe(limits, all).end(), "scene.xyz", limits);
        return text == "read" ? "" : text;
    } catch (const core::Error& error) {
        return error.what();
    }
}

TEST_F(Probes, SayNothingOfWhatGoesWell) {
    EXPECT_EQ(complaint_of({"well"}), "");
}

TEST_F(Probes, PassOnWhatTheReaderRefuses) {
    EXPECT_EQ(complaint_of({"refuse"}), "reading a.obj: no such mesh");
}

TEST_F(Probes, WhichDoNotBeginAreNoDamagedFiles) {
    const ProbeLimits limits = limits_for(std::uintmax_t{10});
    setenv("RENDER2MPEG_PROGRAM", "/bin/false", 1);
    const ProbeEnd end = Probe(limits, {"read", "well"}).end();
    setenv("RENDER2MPEG_PROGRAM", readings.c_str(), 1);
    EXPECT_EQ(end.how, ProbeEnd::How::not_begun);
    EXPECT_NE(end.text.find("/bin/false"), std::string::npos);
    EXPECT_EQ(Probe(limits, {"a kind of another version"}).end().how, ProbeEnd::How::not_begun);
}

TEST_F(Probes, SurviveACrash) {
    for (const char* how : {"abort", "throw", "exit", "contract"})
        EXPECT_EQ(complaint_of({how}), "reading scene.xyz: reading it crashed: the file is damaged") << how;
}

TEST_F(Probes, LeaveInterruptsToTheirParent) {
    EXPECT_EQ(complaint_of({"interrupts"}), "");
}

TEST_F(Probes, DoNotSayThatWhatWasKilledIsDamaged) {
    EXPECT_NE(complaint_of({"kill"}).find("was killed (out of memory?)"), std::string::npos);
}

TEST_F(Probes, EndWithTheirParent) {
    // It says its number, which its probe has among its words: other tests have probes at the same time.
    std::string parent = support::run(readings).output;
    parent.erase(parent.find_last_not_of('\n') + 1);
    ASSERT_FALSE(parent.empty());
    EXPECT_EQ(support::run("timeout 60 sh -c 'while pgrep -f \"^" + readings + " --probe " + parent +
                           " \" > /dev/null; do sleep 0.1; done' || echo still there")
                  .output,
              "");
}

TEST_F(Probes, TellWhatWasReadHoweverLongItIs) {
    EXPECT_EQ(complaint_of({"long"}), std::string(300'000, 'x'));
}

TEST_F(Probes, ReadWhatTheyAreGivenAndTellNothingElse) {
    const std::string input(300'000, 'i');
    Probe probe(limits_for(std::uintmax_t{0}), {"echo", "first "}, std::as_bytes(std::span(input)));
    EXPECT_TRUE(probe.end().text == "first " + input);
}

TEST_F(Probes, ThatNobodyWaitsForAreEnded) {
    const Probe endless(limits_for(std::uintmax_t{0}), {"read", "sleep"});
    Probe given_up(limits_for(std::uintmax_t{0}), {"read", "sleep"});
    int asked = 0;
    EXPECT_EQ(given_up.end([&] { return ++asked > 2; }).how, ProbeEnd::How::given_up);
}

TEST_F(ProbesSlow, EndAParserThatNeverDoes) {
    EXPECT_NE(complaint_of({"loop"}).find("more time than a file of its size can need"), std::string::npos);
}

TEST_F(Probes, BeginWhileOtherThreadsWorkAndEnd) {
    // As a pool's do that is let go.
    const std::jthread others([](const std::stop_token& over) {
        while (!over.stop_requested()) {
            std::vector<std::jthread> ended;
            for (int i = 0; i < 4; ++i) ended.emplace_back([] { std::vector<std::string> memory(100, "some"); });
        }
    });
    for (int i = 0; i < 20; ++i) EXPECT_EQ(complaint_of({"well"}), "");
}

#ifndef RENDER2MPEG_SANITIZED
TEST_F(Probes, RefuseFilesThatTakeAllMemory) {
    for (const char* how : {"hoard", "malloc", "bad_alloc"})
        EXPECT_NE(complaint_of({how}).find("more memory than a file of its size"), std::string::npos) << how;
}

TEST_F(Probes, DoNotSayThatAFileIsDamagedWhereTheUserAllowsLittleMemory) {
    EXPECT_EQ(complaint_of({"half_a_gibibyte"}), "") << "the limit for any file";
    for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
        rlimit before{};
        ASSERT_EQ(getrlimit(resource, &before), 0);
        rlimit little = before;
        little.rlim_cur = std::uintmax_t{400} << 20;
        ASSERT_EQ(setrlimit(resource, &little), 0);
        const std::string complaint = complaint_of({"half_a_gibibyte"});
        setrlimit(resource, &before);
        EXPECT_NE(complaint.find("more memory than this process may have (--memory, ulimit)"), std::string::npos)
            << complaint;
    }
}

TEST(Models, OfAPlyFileThatCountsToABillionAreRefused) {
    unsetenv("RENDER2MPEG_PROGRAM");
    if (!Probe::is_possible()) GTEST_SKIP() << "render2mpeg is not built";
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
