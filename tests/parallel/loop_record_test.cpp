#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "parallel/loops.h"

namespace render2mpeg::parallel {
namespace {

/// Takes about so many seconds of this thread.
void spend(double seconds) {
    const auto now = [] {
        timespec t{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    };
    const double begin = now();
    while (now() - begin < seconds) {
    }
}

TEST(LoopRecord, TellsWhatLoopsAndWhatIsBetweenThemTake) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "loop_record_test.txt";
    const ThreadLimit limit(1);
    {
        const LoopRecord record(file);
        for (int k = 0; k < 2; ++k) {
            spend(0.02);
            for_each(4, [](std::size_t i) {
                spend(i == 0 ? 0.03 : 0.01);
                for_each(3, [](std::size_t) {});  // is part of its task
            });
        }
        spend(0.02);
    }
    std::ifstream in(file);
    std::string row, end, none;
    std::getline(in, row);
    std::getline(in, end);
    EXPECT_FALSE(std::getline(in, none));
    std::istringstream words(row);
    std::string place;
    int line = 0, loops = 0, tasks = 0;
    double all = 0, longest = 0, before = 0;
    std::vector<double> by_threads(std::size(recorded_threads));
    words >> place >> line >> loops >> tasks >> all >> longest >> before;
    for (double& seconds : by_threads) words >> seconds;
    EXPECT_TRUE(place.ends_with("loop_record_test.cpp"));
    EXPECT_EQ(loops, 2);
    EXPECT_EQ(tasks, 8);
    // At least what tasks take on purpose: how much more depends on the machine.
    EXPECT_GE(all, 0.12);
    EXPECT_GE(longest, 0.06);
    EXPECT_GE(before, 0.04);
    EXPECT_GE(std::stod(end), 0.02);
    EXPECT_LE(longest, all);
    // 0.03 beside three of 0.01 by two threads; by more, the longest tasks alone.
    EXPECT_LT(by_threads[0], all);
    EXPECT_GE(by_threads[0], longest - 1e-6);
    EXPECT_NEAR(by_threads.back(), longest, 1e-6);
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace render2mpeg::parallel
