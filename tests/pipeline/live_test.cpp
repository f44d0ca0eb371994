#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <glm/gtc/packing.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/places.h"
#include "tests/support/program.h"

namespace render2mpeg {
namespace {

using nlohmann::json;

struct Answer {
    json says;  ///< null: the program has ended
    std::vector<std::uint16_t> halves;
};

/// `watch --live` with both of its pipes.
class LiveProgram {
  public:
    explicit LiveProgram(const std::string& scene, const std::string& size = "64x48") {
        int in[2], out[2];
        if (pipe(in) != 0 || pipe(out) != 0) return;
        process_ = fork();
        if (process_ == 0) {
            dup2(in[0], STDIN_FILENO);
            dup2(out[1], STDOUT_FILENO);
            for (const int end : {in[0], in[1], out[0], out[1]}) close(end);
            const std::string program = support::program();
            execl(program.c_str(), program.c_str(), "watch", scene.c_str(), "--live", "--quiet", "--size", size.c_str(),
                  static_cast<char*>(nullptr));
            _exit(127);
        }
        close(in[0]);
        close(out[1]);
        to_ = in[1];
        from_ = fdopen(out[0], "rb");
    }
    ~LiveProgram() {
        if (process_ > 0) kill(process_, SIGKILL);
        status();
        end_input();
        close_output();
    }
    LiveProgram(const LiveProgram&) = delete;
    LiveProgram& operator=(const LiveProgram&) = delete;

    void say(const std::string& line) {
        const std::string whole = line + "\n";
        EXPECT_EQ(write(to_, whole.data(), whole.size()), static_cast<ssize_t>(whole.size()));
    }
    Answer answer() {
        Answer answer;
        std::string line;
        for (int c = std::fgetc(from_); c != EOF && c != '\n'; c = std::fgetc(from_)) line += static_cast<char>(c);
        if (line.empty()) return answer;
        answer.says = json::parse(line);
        answer.halves.resize(answer.says.value("bytes", std::size_t{0}) / 2);
        EXPECT_EQ(std::fread(answer.halves.data(), 2, answer.halves.size(), from_), answer.halves.size());
        return answer;
    }
    /// The next answer that has this key.
    Answer answer_with(const std::string& key) {
        Answer found = answer();
        while (!found.says.is_null() && !found.says.contains(key)) found = answer();
        return found;
    }
    /// The first picture that shows what this line asked for.
    Answer picture_of(int line) {
        Answer found = answer_with("picture");
        while (!found.says.is_null() && found.says["line"] < line) found = answer_with("picture");
        return found;
    }
    /// The last and best one.
    Answer best_of(int line) {
        Answer found = picture_of(line);
        while (!found.says.is_null() && !found.says["best"]) found = answer_with("picture");
        return found;
    }
    void end_input() {
        if (to_ >= 0) close(to_);
        to_ = -1;
    }
    void close_output() {
        if (from_ != nullptr) std::fclose(from_);
        from_ = nullptr;
    }
    /// Exit status, once it has ended.
    int status() {
        if (process_ <= 0) return status_;
        int status = 0;
        waitpid(process_, &status, 0);
        process_ = -1;
        return status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }

  private:
    pid_t process_ = -1;
    int to_ = -1, status_ = -1;
    std::FILE* from_ = nullptr;
};

double mean_of(const Answer& picture) {
    double sum = 0;
    for (std::size_t i = 0; i < picture.halves.size(); ++i)
        if (i % 4 != 3) sum += static_cast<double>(glm::unpackHalf1x16(picture.halves[i]));
    return sum / (0.75 * static_cast<double>(picture.halves.size()));
}

/// Mean difference of two pictures over the mean of the first.
double difference_of(const Answer& a, const Answer& b) {
    EXPECT_EQ(a.halves.size(), b.halves.size());
    double sum = 0;
    for (std::size_t i = 0; i < std::min(a.halves.size(), b.halves.size()); ++i)
        sum += std::abs(static_cast<double>(glm::unpackHalf1x16(a.halves[i]) - glm::unpackHalf1x16(b.halves[i])));
    return sum / (0.75 * static_cast<double>(a.halves.size())) / mean_of(a);
}

/// The camera of the plain box, and another one.
const std::string own_camera =
    R"({"camera": {"matrix": [1,0,0,0, 0,0.8074,0.59,2.2, 0,-0.59,0.8074,2.6, 0,0,0,1], "fov": 35.9}})";
const std::string from_the_left =
    R"({"camera": {"matrix": [1,0,0,-0.8, 0,0.8074,0.59,2.2, 0,-0.59,0.8074,2.6, 0,0,0,1], "fov": 35.9}})";

TEST(LiveView, BeginsQuicklyAndEndsWithThePictureByRays) {
    LiveProgram program(support::plain_film());
    const Answer scene = program.answer();
    EXPECT_EQ(scene.says["size"], json({64, 48})) << scene.says;
    const Answer quick = program.answer();
    EXPECT_EQ(quick.says["level"], "quick") << quick.says;
    EXPECT_EQ(quick.says["line"], 0);
    int drafts = 0;
    Answer last = quick;
    while (!last.says.is_null() && !last.says["best"]) {
        last = program.answer();
        EXPECT_EQ(last.says["size"], json({64, 48})) << last.says;
        EXPECT_EQ(last.halves.size(), 64u * 48u * 4u);
        if (last.says["level"] != "draft") continue;
        ++drafts;
        EXPECT_EQ(last.says["pass"], drafts + (quick.says["size"] == json({64, 48}) ? 1 : 0));
    }
    EXPECT_EQ(last.says["level"], "lit");
    EXPECT_GE(drafts, 4);
    // All are pictures of the same light.
    EXPECT_GT(mean_of(last), 0);
    EXPECT_NEAR(mean_of(quick), mean_of(last), 0.25 * mean_of(last));
    program.end_input();
    EXPECT_EQ(program.status(), 0);
}

TEST(LiveView, OfAGivenCameraIsThatOfTheFilmsOwnInTheSamePlaceSlow) {
    LiveProgram program(support::plain_film());
    const Answer own = program.best_of(0);
    program.say(from_the_left);
    const Answer other = program.best_of(1);
    program.say(own_camera);
    const Answer same = program.best_of(2);
    EXPECT_GT(difference_of(own, other), 0.1);
    EXPECT_LT(difference_of(own, same), 0.02);
    program.say(R"({"camera": null})");
    EXPECT_LT(difference_of(own, program.best_of(3)), 0.02);
}

TEST(LiveView, DropsWhatIsBeingRefinedWhenALineComes) {
    // A large picture by rays takes many seconds.
    LiveProgram program(support::plain_film(), "1280x960");
    program.answer_with("picture");
    for (int line = 1; line <= 3; ++line) {
        program.say(line % 2 == 0 ? own_camera : from_the_left);
        const Answer quick = program.picture_of(line);
        EXPECT_EQ(quick.says["level"], "quick") << quick.says;
        EXPECT_EQ(quick.says["line"], line);
    }
    // Smaller ones are the same film's.
    program.say(R"({"size": [32, 32]})");
    EXPECT_LE(program.picture_of(4).says["size"][0], 32);
    program.say(R"({"quit": true})");
    while (!program.answer().says.is_null()) continue;
    EXPECT_EQ(program.status(), 0);
}

TEST(LiveView, AnswersABadLineByOneLineAndGoesOn) {
    LiveProgram program(support::plain_film());
    program.answer_with("picture");
    const std::vector<std::pair<std::string, std::string>> bad{
        {"nonsense", "expected a JSON object"},
        {"[1, 2]", "expected a JSON object"},
        {R"({"camara": null})", "there is no \"camara\""},
        {R"({"camera": {"matrix": [1, 2]}})", "16 numbers"},
        {R"({"camera": {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1e99]}})", "a number up to 1e9"},
        {R"({"camera": {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "fov": 180}})", "between 0 and 180"},
        {R"({"camera": {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "fov": 179.999999}})", "between 0 and 180"},
        {R"({"camera": {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "height": 1e-60}})", "above 0"},
        {R"({"camera": {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "clip": [5, 1]}})", "near < far"},
        {R"({"size": [4, 400000]})", "16 to 16384"},
        {R"({"frame": 0.5})", "a whole number"},
        {R"({"scene": "no such file.glb"})", "there is no such file"},
    };
    for (std::size_t i = 0; i < bad.size(); ++i) {
        program.say(bad[i].first);
        const Answer told = program.answer_with("error");
        ASSERT_FALSE(told.says.is_null()) << bad[i].first;
        EXPECT_NE(told.says["error"].get<std::string>().find(bad[i].second), std::string::npos) << told.says;
        EXPECT_EQ(told.says["line"], i + 1);
    }
    program.say(own_camera);
    EXPECT_EQ(program.picture_of(static_cast<int>(bad.size()) + 1).says["level"], "quick");
    program.say(R"({"scene": ")" + support::panel_film() + R"("})");
    EXPECT_EQ(program.answer_with("scene").says["scene"], support::panel_film());
    EXPECT_FALSE(program.answer_with("picture").says.is_null());
}

TEST(LiveView, EndsWhereItsInputOrItsReaderGoesSlow) {
    LiveProgram program(support::plain_film(), "1280x960");
    program.answer_with("picture");
    program.end_input();
    EXPECT_EQ(program.status(), 0);

    LiveProgram other(support::plain_film());
    other.answer_with("picture");
    other.say(R"({"scene": ")" + support::panel_film() + R"("})");
    other.end_input();
    EXPECT_EQ(other.answer_with("scene").says["scene"], support::panel_film()) << "said before the end";
    EXPECT_EQ(other.status(), 0);

    LiveProgram unread(support::plain_film(), "1280x960");
    unread.answer_with("picture");
    unread.close_output();
    EXPECT_EQ(unread.status(), 0);
}

/// Blender's own window on a screen that nobody sees.
TEST(LiveWindow, ShowsTheSceneAndItsChangesAndLeavesNothingBehindSlow) {
    if (support::run("which blender xvfb-run").status != 0) GTEST_SKIP() << "there is no blender, or no xvfb-run";
    const support::Folder folder;
    const auto script = [](const char* name) { return (support::source_folder() / "tests/blender" / name).string(); };
    const auto made =
        support::blender("-P " + script("make_blends.py") + " -- " + folder.path().string() + " glass_and_emission");
    ASSERT_EQ(made.status, 0) << made.output;
    const auto shown = support::run(
        "RENDER2MPEG_PROGRAM=" + support::program() +
        " timeout 500 xvfb-run -a -s '-screen 0 1024x640x24' blender --factory-startup -noaudio --window-geometry 0 0 "
        "1000 600 " +
        (folder / "glass_and_emission.blend").string() + " -P " + script("live_window.py") + " -- " +
        folder.path().string());
    const json told = json::parse(support::contents(folder / "live.json"), nullptr, false);
    ASSERT_TRUE(told.is_object()) << shown.output;
    ASSERT_FALSE(told.contains("error")) << told["error"].get<std::string>() << shown.output;
    // Light of 0.18 is shown as sRGB has it: colour management took place, once.
    EXPECT_NEAR(told["light"].get<double>(), 0.18, 0.005);
    EXPECT_NEAR(told["grey"].get<double>(), 117.6, 2);
    for (const json& process : told["pids"])
        EXPECT_FALSE(std::filesystem::exists("/proc/" + std::to_string(process.get<int>()))) << process;
    EXPECT_FALSE(std::filesystem::exists(told["folder"].get<std::string>()));
    // One export for each of the changes: none for what exporting does itself.
    EXPECT_EQ(told["exports"], 3);
}

}  // namespace
}  // namespace render2mpeg
