#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <set>
#include <string>
#include <thread>

#include "app/files/file_io.h"
#include "app/files/work_folder.h"
#include "app/options/options.h"
#include "app/production/resume.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "core/error.h"
#include "pipeline/fixture.h"

/// What a careless or hostile surrounding does to a run: closed descriptors, links of others, names full of codes.
namespace render2mpeg::test {
namespace {

const std::string few_rays = " --size 32x32 --samples 1 --exposure 0 --tolerance fixed=10% --frames 0:1 ";

std::string render_in(const Folder& folder, const std::string& output, const std::string& more = "--quiet") {
    return program() + " render " + plain_film() + few_rays + more + " -o '" + path(folder, output) + "'";
}

void put_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

bool mentions(const support::Outcome& outcome, const std::string& words) {
    return outcome.output.find(words) != std::string::npos;
}

TEST(StandardDescriptors, ThatAreClosedAreNoFilesOfOursSlow) {
    const Folder folder;
    ASSERT_EQ(run(render_in(folder, "whole.m2v")).status, 0);
    // Progress is told, so that it would go into whatever has number 2.
    const std::string start = render_in(folder, "f.m2v", "");
    for (const char* closed : {" 2>&- <&-", " 2>&- >&-", " <&- >&- 2>&-"}) {
        run(start + closed);
        EXPECT_TRUE(contents(folder / "f.m2v") == contents(folder / "whole.m2v")) << closed;
        std::filesystem::remove(folder / "f.m2v");
    }
    EXPECT_EQ(run(program() + " info " + path(folder, "none") + " 2>" + path(folder, "said") + " <&- >&-").status, 1);
    EXPECT_EQ(contents(folder / "said").find("render2mpeg: "), 0u) << contents(folder / "said");
    const auto full = run(program() + " info " + path(folder, "whole.m2v") + " >&-");
    EXPECT_EQ(full.status, 1) << "what is closed cannot be written to";
}

TEST(OwnFiles, AreReadUnlessNestedDeeperThanOurs) {
    EXPECT_EQ(app::parsed_json(R"({"a": [1, {"b": null}]})").dump(), R"({"a":[1,{"b":null}]})");
    EXPECT_TRUE(app::parsed_json(std::string(32, '[') + std::string(32, ']')).is_array());
    EXPECT_TRUE(app::parsed_json(std::string(33, '[') + std::string(33, ']')).is_discarded());
    EXPECT_TRUE(app::parsed_json("{").is_discarded());
}

TEST(OwnFiles, ThatAreDamagedAreRefusedInOneLine) {
    const Folder folder;
    const std::string film = program() + " render " + plain_film() + few_rays + "--quiet --resume -o " +
                             path(folder, "f.mpg"),
                      deep = std::string(100'000, '[') + std::string(100'000, ']'),
                      work = path(folder, "f.mpg.partial");
    for (const std::string& manifest : {deep, R"({"identity": )" + deep + "}", std::string("[]"),
                                        std::string("nothing"), std::string("{\"identity\"")}) {
        std::filesystem::create_directory(work);
        put_text(work + "/manifest.json", manifest);
        const auto outcome = run(film);
        EXPECT_EQ(outcome.status, 1) << manifest.substr(0, 20);
        EXPECT_TRUE(mentions(outcome, "manifest.json is damaged")) << outcome.output;
        std::filesystem::remove_all(work);
    }
}

TEST(Interrupts, LeaveErrnoAndAreAllCounted) {
    const app::InterruptGuard guard(true);
    EXPECT_FALSE(app::InterruptGuard::requested());
    errno = ENOSPC;
    std::thread([] { std::raise(SIGTERM); }).join();
    EXPECT_EQ(errno, ENOSPC);
    EXPECT_TRUE(app::InterruptGuard::requested());
    EXPECT_EQ(app::InterruptGuard::status(), 128 + SIGTERM);
}

TEST(Interrupts, ThatTheProgramWasStartedToIgnoreAreIgnored) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const auto before = std::signal(signal, SIG_IGN);
        {
            const app::InterruptGuard guard(true);
            std::raise(signal);
            EXPECT_FALSE(app::InterruptGuard::requested()) << signal;
        }
        EXPECT_EQ(std::signal(signal, before), SIG_IGN) << "and stay so";
    }
}

TEST(WorkFolder, ThatIsALinkIsNotFollowed) {
    const Folder folder, victim;
    std::filesystem::create_directory_symlink(victim.path(), folder / "f.mpg.partial");
    put_text(victim / "manifest.json", "{}");
    put_text(victim / "diary", "mine");
    for (const char* more : {"--quiet", "--quiet --dry-run", "--quiet --resume"}) {
        const auto outcome = run(render_in(folder, "f.mpg", more));
        EXPECT_EQ(outcome.status, 1) << more;
        EXPECT_TRUE(mentions(outcome, "f.mpg.partial: it is a link, which is not followed")) << outcome.output;
    }
    EXPECT_EQ(contents(victim / "diary"), "mine");
    EXPECT_EQ(victim.entries(), 2u);
}

TEST(WorkFolder, OfAnotherUserIsLeftAlone) {
    if (geteuid() != 0) GTEST_SKIP() << "only root gives files away";
    const Folder folder;
    const std::filesystem::path work = folder / "f.mpg.partial";
    std::filesystem::create_directory(work);
    put_text(work / "manifest.json", "{}");
    ASSERT_EQ(chown(work.c_str(), 12345, 12345), 0);
    const auto outcome = run(render_in(folder, "f.mpg"));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(mentions(outcome, "f.mpg.partial: it belongs to another user")) << outcome.output;
    EXPECT_EQ(contents(work / "manifest.json"), "{}");
}

TEST(Lock, ThatIsALinkIsNotFollowed) {
    const Folder folder;
    const std::string victim = "a file that is somebody's";
    put_text(folder / "victim", victim);
    std::filesystem::create_directory(folder / "f.mpg.partial");
    for (const bool symbolic : {true, false}) {
        const std::filesystem::path lock = folder / "f.mpg.partial" / "lock";
        if (symbolic)
            std::filesystem::create_symlink(folder / "victim", lock);
        else
            std::filesystem::create_hard_link(folder / "victim", lock);
        EXPECT_THROW(app::OutputLock(lock, "film"), core::Error) << symbolic;
        const auto outcome = run(render_in(folder, "f.mpg"));
        EXPECT_EQ(outcome.status, 1) << symbolic;
        EXPECT_EQ(contents(folder / "victim"), victim) << symbolic;
        std::filesystem::remove(lock);
    }
}

TEST(Messages, DoNothingToATerminalWhateverFilesAreCalled) {
    const Folder folder;
    const std::string evil = "a\x1b[31m\nrender2mpeg: all is well\x07";
    for (const std::string& command :
         {program() + " info '" + path(folder, evil) + "'",
          program() + " render '" + path(folder, evil + ".glb") + "' -o " + path(folder, "f.mpg"),
          render_in(folder, evil + ".xyz"), program() + " '" + evil + "'", program() + " render '--" + evil + "'"}) {
        const auto outcome = run(command);
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << command;
        EXPECT_EQ(outcome.output.find_first_of("\x1b\x07"), std::string::npos) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    }
    // What goes well is told in several lines of our own.
    const auto outcome = run(render_in(folder, evil + ".m2v", ""));
    ASSERT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.output.find_first_of("\x1b\x07"), std::string::npos) << outcome.output;
    EXPECT_EQ(outcome.output.find("\nrender2mpeg: all"), std::string::npos) << outcome.output;
    const auto told = run(program() + " info '" + path(folder, evil + ".m2v") + "'");
    EXPECT_EQ(told.status, 0);
    EXPECT_EQ(told.output.find_first_of("\x1b\x07"), std::string::npos) << told.output;
    EXPECT_EQ(told.output.find("\nrender2mpeg: all"), std::string::npos) << told.output;
}

TEST(Messages, DoNothingToATerminalWhateverAnAnimationFileSays) {
    const Folder folder;
    std::filesystem::copy(plain_film(), folder / "scene", std::filesystem::copy_options::recursive);
    for (const auto& entry : std::filesystem::directory_iterator(folder / "scene")) {
        if (entry.path().extension() != ".json") continue;
        json film = json::parse(contents(entry.path()), nullptr, true, true);  // with comments
        film["\x1b]0;mine\x07\nrender2mpeg: all is well"] = 1;
        put_text(entry.path(), film.dump());
    }
    const auto outcome = run(program() + " plan --within 0 " + path(folder, "scene"));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.output.find_first_of("\x1b\x07"), std::string::npos) << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
}

TEST(Progress, IsOneLineWhateverIsCounted) {
    const std::string line = app::progress_line({"fr\x1b[31mame\n", 1, 2, 1, 1, true, {}}, 1000, false);
    EXPECT_EQ(line.find_first_of("\x1b\n"), std::string::npos) << line;
}

TEST(Words, OfACommandComeBackOutOfAShell) {
    for (const std::string word : {"plain.mpg", "it's a $film", "a\x1b[31m\nb\\'c\xff", ""}) {
        const auto outcome = run("bash -c " + app::quoted("printf %s " + app::quoted(word)));
        EXPECT_EQ(outcome.output, word);
        EXPECT_EQ(app::quoted(word).find_first_of("\x1b\n\xff"), std::string::npos);
    }
}

TEST(Outputs, ThatMayNotGrowSaySo) {
    const Folder folder;
    // Blocks of 512 bytes; the signal that comes with it is not ignored by the shell.
    const auto outcome = run("ulimit -f 1; " + render_in(folder, "f.y4m"));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(mentions(outcome, "File too large")) << outcome.output;
}

TEST(Outputs, ThatArePipesAreWrittenToAndStaySlow) {
    const Folder folder;
    ASSERT_EQ(run(render_in(folder, "whole.ts")).status, 0);
    ASSERT_EQ(run(render_in(folder, "whole.y4m")).status, 0);
    for (const std::string ending : {".ts", ".y4m"}) {
        const std::filesystem::path pipe = folder / ("pipe" + ending);
        ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
        const auto outcome = run("cat " + pipe.string() + " > " + path(folder, "read") + " & " +
                                 render_in(folder, "pipe" + ending) + "; echo status $?; wait");
        EXPECT_TRUE(mentions(outcome, "status 0")) << outcome.output;
        EXPECT_TRUE(std::filesystem::is_fifo(pipe)) << ending;
        EXPECT_TRUE(contents(folder / "read") == contents(folder / ("whole" + ending))) << ending;
        std::filesystem::remove(pipe);
    }
    EXPECT_EQ(folder.entries(), 3u) << "no work folder is left";
}

TEST(Outputs, BehindALoopOfLinksAreRefusedInALine) {
    const Folder folder;
    std::filesystem::create_symlink("b", folder / "a");
    std::filesystem::create_symlink("a", folder / "b");
    std::filesystem::create_symlink("loop.mpg", folder / "loop.mpg");
    std::filesystem::create_symlink("g.mpg.partial", folder / "g.mpg.partial");
    for (const char* output : {"loop.mpg", "a/f.mpg", "g.mpg"}) {
        const auto outcome = run(render_in(folder, output));
        EXPECT_EQ(outcome.status, 1) << output;
        EXPECT_EQ(outcome.output.find("render2mpeg: writing "), 0u) << outcome.output;
        EXPECT_FALSE(mentions(outcome, "filesystem error")) << outcome.output;
    }
    const auto input = run(program() + " plan --within 0 " + path(folder, "a"));
    EXPECT_EQ(input.status, 1);
    EXPECT_FALSE(mentions(input, "filesystem error")) << input.output;
}

TEST(Kills, LeaveNothingThatTheNextRunDoesNotRemove) {
    const Folder folder;
    // As runs left them that were killed while they wrote: the process is none any more.
    const std::string dead = run("sh -c 'echo $$'").output;
    const std::string mark = ".render2mpeg-" + dead.substr(0, dead.size() - 1) + "-0.tmp";
    put_text(folder / ("s.json" + mark), "{");
    put_text(folder / "s.json.render2mpeg-notes.tmp", "mine");
    put_text(folder / ("other.json" + mark), "another file's");
    const std::string alive = "s.json.render2mpeg-" + std::to_string(getpid()) + "-0.tmp";
    put_text(folder / alive, "somebody is at it");
    app::write_whole(folder / "s.json", "{}");
    EXPECT_EQ(contents(folder / "s.json"), "{}");
    EXPECT_FALSE(std::filesystem::exists(folder / ("s.json" + mark)));
    EXPECT_EQ(contents(folder / "s.json.render2mpeg-notes.tmp"), "mine");
    EXPECT_EQ(contents(folder / alive), "somebody is at it");
    EXPECT_EQ(folder.entries(), 4u);
}

TEST(Kills, LeaveNoFilesThatWereOnlyToBeTried) {
    const Folder folder;
    // Whoever is stopped between making and removing such a file leaves it: none is made.
    const int watch = inotify_init1(IN_NONBLOCK);
    ASSERT_GE(inotify_add_watch(watch, folder.path().c_str(), IN_CREATE), 0);
    ASSERT_EQ(run(render_in(folder, "f.m2v", "--quiet --stats " + path(folder, "s.json"))).status, 0);
    alignas(inotify_event) std::array<char, 1 << 14> events;
    std::set<std::string> made;
    for (ssize_t size = 0; (size = read(watch, events.data(), events.size())) > 0;)
        for (ssize_t at = 0; at < size;) {
            const auto* const event = reinterpret_cast<const inotify_event*>(events.data() + at);
            made.insert(std::string(event->name).substr(0, 6));
            at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
        }
    close(watch);
    EXPECT_EQ(made, (std::set<std::string>{"f.m2v.", "s.json"})) << "the work folder, and statistics on their way";
}

}  // namespace
}  // namespace render2mpeg::test
