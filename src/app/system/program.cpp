#include "app/system/program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <thread>

#include "app/system/interrupt.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

std::string player_at_hand(const std::string& wanted) {
    if (!wanted.empty()) {
        if (!is_installed(wanted)) throw core::Error("player " + wanted + ": there is no such program");
        return wanted;
    }
    const auto is_set = [](const char* name) { return std::getenv(name) != nullptr; };
    if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") && !is_set("SDL_VIDEODRIVER"))
        throw core::Error("player: there is no display; -o draft.mp4 writes each draft to a file instead");
    for (const char* known : {"ffplay", "mpv"})
        if (is_installed(known)) return known;
    throw core::Error("player: neither ffplay nor mpv is installed; name one with --player, or a file with -o");
}

/// Shows the first picture at once, and keeps the last.
std::vector<std::string> words_of(const std::string& program, const std::string& title, const std::string& rate) {
    const std::string name = std::filesystem::path(program).filename();
    if (name == "mpv")
        return {program,
                "--really-quiet",
                "--no-cache",
                "--demuxer-lavf-format=mpegvideo",
                "--demuxer-lavf-o=framerate=" + rate,
                "--keep-open=always",
                "--force-window=yes",
                "--title=" + title,
                "-"};
    if (name == "ffplay")
        return {program,      "-hide_banner", "-loglevel",     "error", "-f",      "mpegvideo",
                "-framerate", rate,           "-probesize",    "32768", "-fflags", "nobuffer",
                "-flags",     "low_delay",    "-window_title", title,   "-i",      "pipe:0"};
    return {program};
}

/// Where a program's standard streams lead; below 0: as they are.
struct Streams {
    int input = -1, output = -1, errors = -1;
    bool own_group = false;  ///< of processes: interrupts of the terminal do not reach it
};

/// Starts a program. 127 where there is none; below 0 without a process.
pid_t started(std::vector<std::string>& words, const Streams& streams, const std::filesystem::path& folder = {}) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t child = fork();
    if (child != 0) return child;
    if (streams.own_group) setpgid(0, 0);
    if (streams.input >= 0) dup2(streams.input, STDIN_FILENO);
    if (streams.output >= 0) dup2(streams.output, STDOUT_FILENO);
    if (streams.errors >= 0) dup2(streams.errors, STDERR_FILENO);
    for (const int ignored : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM, SIGHUP})
        if (streams.input >= 0) signal(ignored, SIG_DFL);
    if (folder.empty() || chdir(folder.c_str()) == 0) execvp(arguments[0], arguments.data());
    _exit(127);
}

}  // namespace

bool is_installed(const std::string& program) {
    if (program.find('/') != std::string::npos) return access(program.c_str(), X_OK) == 0;
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
    return false;
}

Finished run_program(std::vector<std::string> words, Output output, const std::filesystem::path& folder) {
    const bool caught = output == Output::caught;
    int ends[2] = {-1, -1};
    if (caught && pipe2(ends, O_CLOEXEC) != 0) throw core::Error("running", words[0], std::strerror(errno));
    Finished finished;
    const int nowhere = output == Output::errors_passed_on ? open("/dev/null", O_WRONLY | O_CLOEXEC) : -1;
    const pid_t child = started(words, {-1, caught ? ends[1] : nowhere, ends[1], output != Output::passed_on}, folder);
    if (caught) close(ends[1]);
    if (nowhere >= 0) close(nowhere);
    char buffer[4096];
    while (caught) {
        const ssize_t n = read(ends[0], buffer, sizeof buffer);
        if (n > 0) finished.text.append(buffer, static_cast<std::size_t>(n));
        if (n == 0 || (n < 0 && errno != EINTR)) break;
    }
    if (caught) close(ends[0]);
    if (child < 0) throw core::Error("running", words[0], "no process to be had");
    int status = 0;
    rusage usage{};
    // Signals restart what waits, so that one who hands them on has to look.
    const bool watches = output == Output::errors_passed_on;
    for (pid_t ended = 0; ended != child;) {
        ended = wait4(child, &status, watches ? WNOHANG : 0, &usage);
        if (ended < 0 && errno != EINTR) break;
        if (ended != 0) continue;
        if (InterruptGuard::requested()) kill(-child, SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    finished.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    for (const timeval& t : {usage.ru_utime, usage.ru_stime})
        finished.seconds += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    return finished;
}

void Player::check(const std::string& program) {
    player_at_hand(program);
}

Player::Player(const std::string& program, const std::string& title, const std::string& frame_rate)
    : name_(player_at_hand(program)) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw core::Error("starting", name_, std::strerror(errno));
    std::vector<std::string> words = words_of(name_, title, frame_rate);
    process_ = started(words, {ends[0], -1, -1, true});
    close(ends[0]);
    pipe_ = ends[1];
    if (process_ >= 0) return;
    close(pipe_);
    throw core::Error("starting", name_, "no process to be had");
}

Player::~Player() {
    close(pipe_);
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
}

}  // namespace render2mpeg::app
