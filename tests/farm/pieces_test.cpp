#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "app/options/option_text.h"
#include "app/options/usage_error.h"
#include "core/checksum.h"
#include "farm/farm_film.h"

/// A film is made by machines that share no folder: each writes its chunks as files, which any program brings together.
namespace render2mpeg {
namespace {

using support::contents;
using support::run;
using test::FarmFilm;

TEST(HookCommands, AreWordsAsAShellPartsThemAndNothingElse) {
    using Words = std::vector<std::string>;
    EXPECT_EQ(app::command_from("rclone copy {} remote:film/"), (Words{"rclone", "copy", "{}", "remote:film/"}));
    EXPECT_EQ(app::command_from("  a  'b  c'd\"e 'f\"\t'' "), (Words{"a", "b  cde 'f", ""}));
    EXPECT_EQ(app::command_from("a;b $(c) `d` \\ *"), (Words{"a;b", "$(c)", "`d`", "\\", "*"}));
    for (const char* wrong : {"", "  ", "''", "a 'b", "a \"b'"})
        EXPECT_THROW(app::command_from(wrong), app::UsageError);
}

/// A film whose machines have a copy of its plan each and nothing else in common.
class Machines {
  public:
    explicit Machines(FarmFilm& film, const std::string& outputs = "", const std::string& more = "--parts 2")
        : film_(film) {
        const std::string names = outputs.empty() ? "-o " + film.path("f.mpg") : outputs;
        planned_ = film.farm(names, "--to parallel " + more);
    }
    const support::Outcome& planned() const { return planned_; }
    /// Of a machine of this name, which has its plan from now on.
    std::string part(const std::string& machine, int number, const std::string& more = "") const {
        std::filesystem::create_directories(film_ / machine);
        std::filesystem::copy(film_ / "f.mpg.farm", film_ / (machine + "/f.mpg.farm"),
                              std::filesystem::copy_options::recursive | std::filesystem::copy_options::skip_existing);
        return film_.part(machine + "/f.mpg.farm", number) + " --into " + film_.path(machine + "/out") + " " + more;
    }
    /// The same where no file can be locked.
    std::string lockless(const std::string& command) const {
        return (support::binary_folder() / "refuse_locks").string() + " " + command;
    }
    /// Copies what a machine wrote into a folder of what was brought.
    void bring(const std::string& machine, const std::string& folder) const {
        std::filesystem::create_directories(film_ / folder);
        std::filesystem::copy(
            film_ / (machine + "/out"), film_ / folder,
            std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
    }
    std::filesystem::path piece(const std::string& folder, int chunk) const {
        return film_ / (folder + "/f.mpg.chunk_0000" + std::to_string(chunk));
    }

  private:
    FarmFilm& film_;
    support::Outcome planned_;
};

std::string outputs_named(const FarmFilm& film, const std::string& name) {
    return "-o " + film.path(name + ".mpg") + " --stats " + film.path(name + ".json") + " --aov " +
           film.path(name + "_layers") + " --heatmap quantiser " + film.path(name + "_q.mpg");
}

TEST(Pieces, MakeAllThatOneRunMakesInAnyOrderAndTwiceWhereNothingIsLockedSlow) {
    FarmFilm film("", 240);
    ASSERT_EQ(film.render(outputs_named(film, "one")).status, 0);
    const Machines machines(film, outputs_named(film, "f"));
    ASSERT_EQ(machines.planned().status, 0) << machines.planned().output;
    const auto refused = run(machines.lockless(film.part("f.mpg.farm", 1)));
    if (refused.status == 77) GTEST_SKIP() << refused.output;
    EXPECT_NE(refused.output.find("it cannot be locked"), std::string::npos) << refused.output;

    const auto second = run(machines.lockless(machines.part("b", 2)));
    ASSERT_EQ(second.status, 0) << second.output;
    machines.bring("b", "in/late");
    machines.bring("b", "in/again");
    const auto early = film.join("f.mpg.farm", "--from " + film.path("in"));
    EXPECT_EQ(early.status, 1);
    EXPECT_NE(early.output.find("1 of 2 parts are not whole: 1; there is no part 1 (frames 0-119);"), std::string::npos)
        << early.output;
    ASSERT_EQ(run(machines.lockless(machines.part("a", 1))).status, 0);
    machines.bring("a", "in");
    const auto joined = film.join("f.mpg.farm", "--from " + film.path("in"));
    ASSERT_EQ(joined.status, 0) << joined.output;
    EXPECT_EQ(joined.output, "") << "nothing is refused";
    EXPECT_TRUE(film.same("one.mpg", "f.mpg"));
    EXPECT_TRUE(film.same("one_q.mpg", "f_q.mpg"));
    EXPECT_EQ(run("diff -r " + film.path("one_layers") + " " + film.path("f_layers")).output, "");
    EXPECT_EQ(test::lasting_statistics(film / "f.json"), test::lasting_statistics(film / "one.json"));
}

TEST(Pieces, AreNotMadeAgainWhereTheyLieAlreadySlow) {
    FarmFilm film("", 120);
    const Machines machines(film, "", "--parts 1");
    ASSERT_EQ(run(machines.part("a", 1)).status, 0);
    std::filesystem::remove(machines.piece("a/out", 1));
    machines.bring("a", "b/out");
    const std::string first = contents(machines.piece("a/out", 0));
    // Another machine, to which one chunk was brought: it makes the other.
    ASSERT_EQ(run(machines.part("b", 1)).status, 0);
    EXPECT_TRUE(contents(machines.piece("b/out", 0)) == first) << "its times are those of the first machine";
    EXPECT_TRUE(std::filesystem::exists(machines.piece("b/out", 1)));
    // A torn one is made anew.
    std::filesystem::resize_file(machines.piece("b/out", 0), first.size() / 2);
    std::filesystem::remove_all(film / "b/f.mpg.farm");
    ASSERT_EQ(run(machines.part("b", 1)).status, 0);
    EXPECT_GT(std::filesystem::file_size(machines.piece("b/out", 0)), first.size() / 2);
    const auto joined = film.join("f.mpg.farm", "--from " + film.path("b/out"));
    EXPECT_EQ(joined.status, 0) << joined.output;
}

TEST(Pieces, AreRefusedByNameWhereTornChangedForeignOrSwappedSlow) {
    FarmFilm film("", 120), other("--quantiser 9", 120);
    const Machines machines(film), others(other);
    for (const int part : {1, 2}) {
        ASSERT_EQ(run(machines.part("a", part)).status, 0);
        ASSERT_EQ(run(others.part("a", part)).status, 0);
    }
    machines.bring("a", "in");
    const std::string first = contents(machines.piece("a/out", 0)), second = contents(machines.piece("a/out", 1));
    const auto refused = [&](const std::string& bytes, const std::string& why) {
        std::ofstream(machines.piece("in", 1), std::ios::binary) << bytes;
        const auto joined = film.join("f.mpg.farm", "--from " + film.path("in"));
        EXPECT_EQ(joined.status, 1) << joined.output;
        EXPECT_NE(joined.output.find("taking " + machines.piece("in", 1).string() + ": " + why), std::string::npos)
            << joined.output;
        EXPECT_NE(joined.output.find("part 2 (frames 60-119)"), std::string::npos) << joined.output;
    };
    refused("", "it is torn");
    for (const std::size_t bytes : {std::size_t{20}, std::size_t{200}, second.size() / 2, second.size() - 1})
        refused(second.substr(0, bytes), "it is torn");
    std::mt19937 random(7);
    for (int i = 0; i < 8; ++i) {
        std::string changed = second;
        changed[random() % changed.size()] ^= 1 << (random() % 8);
        refused(changed, "it ");
    }
    refused(first, "it holds chunk 0, which is not its name's");
    refused(contents(others.piece("a/out", 1)), "it is of another film");
    // What was refused is in nobody's way.
    std::ofstream(machines.piece("in", 1), std::ios::binary) << second;
    const auto joined = film.join("f.mpg.farm", "--from " + film.path("in"));
    EXPECT_EQ(joined.status, 0) << joined.output;
    EXPECT_TRUE(std::filesystem::exists(film / "f.mpg"));
}

TEST(Pieces, LeadToNoFileOutsideTheirPartSlow) {
    FarmFilm film("", 60);
    const Machines machines(film, "", "--parts 1");
    ASSERT_EQ(run(machines.part("a", 1)).status, 0);
    const std::string whole = contents(machines.piece("a/out", 0));
    const std::size_t head = whole.find('\n') + 1, end = whole.find("]}", head) + 2;
    for (const char* name : {"../../evil.m2v", "/tmp/render2mpeg-evil", "f.mpg.partial/../../evil", "./evil",
                             "f.mpg.partial/manifest.json", "f.mpg.partial/lock"}) {
        nlohmann::json changed = nlohmann::json::parse(whole.substr(head, end - head));
        changed["files"][0]["name"] = name;
        const std::string text = changed.dump();
        core::Checksum sum;
        sum.add(text);
        std::filesystem::create_directories(film / "in");
        std::ofstream(machines.piece("in", 0), std::ios::binary)
            << "render2mpeg piece 1 " << core::checksum_text(text.size()) << ' ' << core::checksum_text(sum.value())
            << '\n'
            << text << whole.substr(end);
        const auto joined = film.join("f.mpg.farm", "--from " + film.path("in"));
        EXPECT_EQ(joined.status, 1);
        EXPECT_NE(joined.output.find(std::string("it would be written to ") + name), std::string::npos)
            << joined.output;
    }
}

TEST(Pieces, AreBroughtByACommandThatReadsTheirNamesAsOneWordSlow) {
    FarmFilm film("", 120);
    const std::string name = "$(touch PWNED) ;'x {} #.mpg";
    ASSERT_EQ(film.render("-o " + film.path("one.mpg")).status, 0);
    ASSERT_EQ(film.farm("-o " + app::quoted(film.path(name)), "--to parallel --parts 1").status, 0);
    std::filesystem::create_directories(film / "in here");
    // A relative name begins where `part` is called.
    const std::string plan = app::quoted(film.path(name + ".farm")),
                      part = "cd " + film.folder().string() + " && " + support::program() +
                             " part --threads 1 --quiet " + plan + " 1 --into out";
    const auto made = run(part + " --after-chunk \"cp {} 'in here/'\"");
    ASSERT_EQ(made.status, 0) << made.output;
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(film / "in here"), {}), 2);
    const auto joined =
        run(support::program() + " join --quiet " + plan + " --from " + app::quoted(film.path("in here")));
    ASSERT_EQ(joined.status, 0) << joined.output;
    EXPECT_TRUE(film.same("one.mpg", name));
    for (const auto& entry : std::filesystem::recursive_directory_iterator(film.folder()))
        EXPECT_NE(entry.path().filename(), "PWNED");
    const auto alone = run(support::program() + " part " + plan + " 1 --after-chunk true");
    EXPECT_EQ(alone.status, 2) << alone.output;
}

TEST(Pieces, AreBroughtAgainWhereThatFailedAndToldWhereItFailsAlwaysSlow) {
    FarmFilm film("", 120);
    const Machines machines(film, "", "--parts 1");
    std::filesystem::create_directories(film / "in");
    std::ofstream(film / "bring")
        << "#!/bin/sh\necho x >> \"$1\"/../tries\n[ $(wc -l < \"$1\"/../tries) -gt 3 ] || { echo "
           "no net today; exit 5; }\ncp \"$2\" \"$1\"\n";
    std::filesystem::permissions(film / "bring", std::filesystem::perms::owner_all);
    const std::string hook = "--after-chunk '" + film.path("bring") + " " + film.path("in") + "'";
    const auto made = run(machines.part("a", 1, hook));
    EXPECT_EQ(made.status, 0) << made.output;
    for (const int chunk : {0, 1})
        EXPECT_TRUE(contents(machines.piece("in", chunk)) == contents(machines.piece("a/out", chunk)));

    const auto failed = run(machines.part("b", 1, "--after-chunk 'sh -c \"echo no net; exit 5\"'"));
    EXPECT_EQ(failed.status, 1);
    EXPECT_NE(failed.output.find("sh ended with status 5: no net; 2 pieces stay in " + film.path("b/out")),
              std::string::npos)
        << failed.output;
    EXPECT_NE(run(machines.part("c", 1, "--after-chunk no-such-program")).output.find("status 127"), std::string::npos);
    // Another try makes nothing and brings all.
    const auto again = run(machines.part("b", 1, "--after-chunk 'cp -t " + film.path("in") + "'"));
    EXPECT_EQ(again.status, 0) << again.output;
    EXPECT_TRUE(contents(machines.piece("in", 1)) == contents(machines.piece("b/out", 1)));
}

/// Kills of random parts at random moments. RENDER2MPEG_KILLS: how many (12).
TEST(Pieces, SurviveKillsAndTwoMachinesThatMakeTheSameSlow) {
    const char* wanted = std::getenv("RENDER2MPEG_KILLS");
    const int kills = wanted == nullptr ? 12 : std::atoi(wanted);
    FarmFilm film("", 240);
    ASSERT_EQ(film.render("-o " + film.path("one.mpg")).status, 0);
    const Machines machines(film);
    std::mt19937 random(3);
    const char* const names[] = {"a", "b", "c"};
    int killed = 0;
    for (int i = 0; i < kills; ++i) {
        // Two at once, now and then both of one machine; pieces are copied while they grow.
        std::string script;
        for (int k = 0; k < 2; ++k)
            script += machines.lockless(machines.part(names[random() % 3], 1 + static_cast<int>(random() % 2),
                                                      "--after-chunk 'cp -t " + film.path("in") + "'")) +
                      " & p" + std::to_string(k) + "=$!; ";
        std::filesystem::create_directories(film / "in");
        script += "sleep 0." + std::to_string(100 + random() % 300) + "; kill -9 $p0 2>/dev/null && echo killed; ";
        script += random() % 2 == 0 ? "kill -9 $p1 2>/dev/null; " : "";
        script += "wait";
        killed += run(script).output.find("killed") != std::string::npos ? 1 : 0;
        if (i % 3 == 2)
            for (const char* name : names) std::filesystem::remove_all(film / name);
    }
    EXPECT_GT(killed, 0) << "parts were at work";
    for (const int part : {1, 2}) {
        const auto made = run(machines.lockless(machines.part("a", part)));
        ASSERT_EQ(made.status, 0) << made.output;
    }
    machines.bring("a", "in");
    const auto joined = film.join("f.mpg.farm", "--from " + film.path("in"));
    ASSERT_EQ(joined.status, 0) << joined.output;
    EXPECT_TRUE(film.same("one.mpg", "f.mpg"));
}

}  // namespace
}  // namespace render2mpeg
