#include <gtest/gtest.h>

#include <string>

#include "farm/farm_film.h"

/// Slurm itself makes a film: munge, slurmctld and slurmd on this machine, for as long as a test runs.
namespace render2mpeg {
namespace {

using support::run;
using test::FarmFilm;

/// Runs a script while there are so many nodes.
support::Outcome on_cluster(const FarmFilm& film, int nodes, const std::string& script) {
    return run("cd " + film.folder().string() + " && " + (support::source_folder() / "tests/farm/slurm.sh").string() +
               " " + std::to_string(nodes) + " bash -c '" + script + "'");
}

/// Waits until the film is there, or nothing is queued any more.
const std::string wait_for_film =
    "for i in $(seq 600); do [ -e f.mpg ] && break; [ -z \"$(squeue --noheader)\" ] && break; sleep 0.2; done; ";

TEST(SlurmSlow, MakesTheFilmThatOneRunMakesAlsoWhenAPartAndASlurmdAreKilled) {
    const FarmFilm film("--bitrate 300k --passes 2", 480);
    const auto names = [&](const std::string& name) {
        return "-o " + film.path(name + ".mpg") + " --heatmap quantiser " + film.path(name + "_q.mpg");
    };
    ASSERT_EQ(film.render(names("one")).status, 0);
    ASSERT_EQ(film.farm(names("f"), "--to slurm --parts 8").status, 0);
    // Behind the first part's first chunk its process and another node's slurmd are killed; that comes back.
    const auto made =
        on_cluster(film, 4,
                   "f.mpg.farm/submit.sh && "
                   "while [ ! -e f.mpg.farm/part_00001/status.json ]; do sleep 0.05; done; "
                   "kill -9 $(sed -n \"s/.*\\\"process\\\": \\([0-9]*\\).*/\\1/p\" f.mpg.farm/part_00001/status.json); "
                   "kill -9 $(cat $CLUSTER/node2.pid); sleep 1; "
                   "slurmd -D -N node2 -f $SLURM_CONF > $CLUSTER/again.out 2>&1 & " +
                       wait_for_film + "cat f.mpg.farm/log/*.txt; ls f.mpg");
    if (made.status == 77) GTEST_SKIP() << made.output;
    EXPECT_EQ(made.status, 0) << made.output;
    EXPECT_NE(made.output.find("Killed"), std::string::npos) << made.output;
    EXPECT_TRUE(film.same("one.mpg", "f.mpg")) << made.output;
    EXPECT_TRUE(film.same("one_q.mpg", "f_q.mpg"));
}

TEST(SlurmSlow, MakesOnlyThePartsThatFailedInAFolderOfAnyName) {
    const FarmFilm film("", 240);
    // A comment, a command and blanks.
    ASSERT_EQ(film.farm("-o '" + film.path("{x} #  $(touch PWNED)/f.mpg") + "'", "--to slurm").status, 0);
    for (const int part : {1, 2, 4}) ASSERT_EQ(run(film.part("?x*/f.mpg.farm", part)).status, 0);
    const auto made =
        on_cluster(film, 2, "cd ?x*; f.mpg.farm/submit.sh; " + wait_for_film + "ls f.mpg.farm/log f.mpg; ls -R ..");
    EXPECT_EQ(made.output.find("PWNED\n"), std::string::npos) << made.output;
    if (made.status == 77) GTEST_SKIP() << made.output;
    EXPECT_EQ(made.status, 0) << made.output;
    EXPECT_NE(made.output.find("parts 3: job "), std::string::npos) << made.output;
    EXPECT_NE(made.output.find("part_3.txt"), std::string::npos) << made.output;
    EXPECT_EQ(made.output.find("part_1.txt"), std::string::npos) << made.output;
}

}  // namespace
}  // namespace render2mpeg
