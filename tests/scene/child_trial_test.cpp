#include "scene/child_trial.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "core/error.h"
#include "scene/load.h"
#include "support/program.h"

namespace render2mpeg::scene {
namespace {

/// What try_in_child says of `reading`; empty when it went well.
std::string complaint_of(const std::function<void()>& reading) {
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
    EXPECT_EQ(complaint_of([&] { ++calls; }), "");
    EXPECT_EQ(calls, 0) << "the child's memory is its own";
}

TEST(ChildTrial, PassesOnWhatTheReaderRefuses) {
    EXPECT_EQ(complaint_of([] { throw core::Error("reading", "a.obj", "no such mesh"); }),
              "reading a.obj: no such mesh");
}

TEST(ChildTrial, SurvivesACrash) {
    EXPECT_NE(complaint_of([] { std::abort(); }).find("crashed"), std::string::npos);
    EXPECT_NE(complaint_of([] { throw 3; }).find("crashed"), std::string::npos);
}

TEST(ChildTrialSlow, EndsAParserThatNeverDoes) {
    const auto endless = [] {
        for (volatile bool on = true; on;) continue;
    };
    EXPECT_NE(complaint_of(endless).find("more time than a file of its size can need"), std::string::npos);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(ChildTrial, RefusesFilesThatTakeAllMemory) {
    const auto hoard = [] {
        std::vector<std::vector<char>> blocks;
        for (int i = 0; i < 64; ++i) blocks.emplace_back(std::size_t{1} << 28, 'x');
    };
    EXPECT_NE(complaint_of(hoard).find("more memory"), std::string::npos);
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
