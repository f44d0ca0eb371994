#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/places.h"
#include "tests/support/program.h"

/// What starts each test, and bounds what a run of them takes.
namespace render2mpeg::checks {
namespace {

/// What `drawn` or other tests do behind tests that took `before` CPU seconds, where 10 are given.
support::Outcome behind(const std::string& before, const std::string& drawn) {
    const support::Folder folder;
    const std::string times = (folder / "times.txt").string();
    std::ofstream(times) << "a.First " << before << " 0.10 0\n"
                         << "a.Second 1.50 9.00 1\n";
    support::Outcome said = support::run("RENDER2MPEG_TEST_TIMES=" + times + " RENDER2MPEG_TEST_BUDGET=10 " +
                                         (support::binary_folder() / "cpu_seconds").string() + " " + drawn +
                                         " a.Third 60 /bin/sh -c 'exit 3'");
    said.output += support::contents(times);
    return said;
}

TEST(CpuSeconds, LeaveOutDrawnTestsWhereTheBudgetIsSpent) {
    const support::Outcome spent = behind("8.50", "--drawn");
    EXPECT_EQ(spent.status, 77);
    EXPECT_EQ(spent.output.find("a.Third"), std::string::npos) << spent.output;
    for (const support::Outcome& run : {behind("8.49", "--drawn"), behind("8.50", "")}) {
        EXPECT_EQ(run.status, 3);
        EXPECT_NE(run.output.find("\na.Third 0.0"), std::string::npos) << run.output;
    }
}

}  // namespace
}  // namespace render2mpeg::checks
