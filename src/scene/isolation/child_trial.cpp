#include "scene/isolation/child_trial.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "core/error.h"

namespace render2mpeg::scene {
namespace {

/// How the child ends on its own. Not 1 and the like, with which libraries and sanitizers end a process themselves.
constexpr int refused = 61, out_of_memory = 62, crashed = 63;

std::uintmax_t address_space_now() {
    std::uintmax_t pages = 0;
    if (std::FILE* statm = std::fopen("/proc/self/statm", "r")) {
        if (std::fscanf(statm, "%ju", &pages) != 1) pages = 0;
        std::fclose(statm);
    }
    return pages * static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
}

/// Time of this process so far, processor seconds.
rlim_t seconds_now() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<rlim_t>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec);
}

rlim_t limit_of(int resource) {
    rlimit both{};
    return getrlimit(resource, &both) == 0 ? both.rlim_cur : RLIM_INFINITY;
}

void lower(int resource, rlim_t limit) {
    rlimit both{};
    if (getrlimit(resource, &both) != 0) return;
    both.rlim_cur = std::min(limit, both.rlim_max);
    setrlimit(resource, &both);
}

/// Limits of what is taken from now on, turn by turn, within those that the process has from others.
class TurnLimits {
  public:
    explicit TurnLimits(const TrialLimits& limits) : limits_(limits) {}

    void begin_turn() const {
#ifndef RENDER2MPEG_SANITIZED
        // Sanitizers reserve more address space than there is memory; they go without this limit.
        lower(RLIMIT_AS, std::min<rlim_t>(memory_, limits_.memory + address_space_now()));
#endif
        if (limits_.seconds > 0) lower(RLIMIT_CPU, std::min<rlim_t>(seconds_, limits_.seconds + seconds_now()));
        lower(RLIMIT_CORE, 0);
        alarm(limits_.clock_seconds);
        errno = 0;
    }

  private:
    TrialLimits limits_;
    rlim_t memory_ = limit_of(RLIMIT_AS), seconds_ = limit_of(RLIMIT_CPU);
};

/// Whether this process, and so its children, may not even take as much memory as a trial: `ulimit`, `--memory`.
bool is_short_of(std::uintmax_t memory) {
    const rlim_t all = limit_of(RLIMIT_AS), own = limit_of(RLIMIT_DATA);
    return (all != RLIM_INFINITY && all < memory + address_space_now()) || (own != RLIM_INFINITY && own < memory);
}

bool write_all(int pipe, std::string_view text) {
    while (!text.empty()) {
        const ssize_t n = write(pipe, text.data(), text.size());
        if (n < 0 && errno != EINTR) return false;
        if (n > 0) text.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
}

/// What the system tells of a thread; empty of one that has ended meanwhile, even between opening and reading.
std::string state_of(const std::filesystem::path& thread) {
    std::string text;
    if (std::FILE* file = std::fopen((thread / "stat").c_str(), "re")) {
        std::array<char, 512> buffer;
        text.assign(buffer.data(), std::fread(buffer.data(), 1, buffer.size(), file));
        std::fclose(file);
    }
    return text;
}

/// Whether every other thread of this process sleeps, or has ended.
bool others_sleep() {
    std::error_code failure;
    std::filesystem::directory_iterator thread("/proc/self/task", failure);
    for (; !failure && thread != std::filesystem::directory_iterator(); thread.increment(failure)) {
        if (thread->path().filename() == std::to_string(gettid())) continue;
        // "ID (NAME) STATE ...": names may hold anything.
        const std::string stat = state_of(thread->path());
        const std::size_t name_end = stat.rfind(") ");
        if (name_end != std::string::npos && stat.find_first_of("RD", name_end) == name_end + 2) return false;
    }
    return !failure;
}

/// A child has one thread alone, and whatever lock another one held when it was made stays locked there for ever: of a
/// sanitizer's or a library's memory, while the threads that a library keeps are about to start. What sleeps holds
/// none as a rule. Gives up after two seconds: what computes all the time was seldom caught with a lock.
void wait_for_others_to_sleep() {
    using namespace std::chrono;
    for (const auto end = steady_clock::now() + seconds(2); !others_sleep() && steady_clock::now() < end;)
        std::this_thread::sleep_for(milliseconds(1));
}

/// Lets the parent alone decide about the child: interrupts are the parent's, and the child ends with it.
void follow(pid_t parent) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
    for (const int signal : {SIGSEGV, SIGABRT, SIGALRM, SIGXCPU}) std::signal(signal, SIG_DFL);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(crashed);  // it has ended already
}

/// The child's whole life: never returns. What it tells goes to `pipe`.
[[noreturn]] void live_as_child(const ChildTrial::Reading& reading, const TrialLimits& limits,
                                const std::function<void(Turn)>& share, int pipe) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    const TurnLimits turn_limits(limits);
    turn_limits.begin_turn();
    int status = 0;
    std::string text;
    try {
        text = reading([&](Turn turn) {
            share(turn);
            turn_limits.begin_turn();
        });
    } catch (const core::Error& error) {
        // Libraries refuse files for want of memory in as many words as there are libraries; malloc() has but one.
        status = errno == ENOMEM ? out_of_memory : refused;
        text = error.what();
    } catch (const std::bad_alloc&) {
        status = out_of_memory;
    } catch (...) {
        status = crashed;
    }
    if (!write_all(pipe, text)) status = crashed;
    _exit(status);
}

/// What the child wrote, until it closed the pipe.
std::string text_of_child(int pipe) {
    std::string text;
    std::array<char, 1024> buffer;
    for (;;) {
        const ssize_t n = read(pipe, buffer.data(), buffer.size());
        if (n > 0) text.append(buffer.data(), static_cast<std::size_t>(n));
        if (n == 0 || (n < 0 && errno != EINTR)) return text;
    }
}

/// Throws what a child that neither read nor refused its file died of; it was to take `memory` at most.
[[noreturn]] void tell_death(const std::string& name, int status, Turn turn, std::uintmax_t memory) {
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    // No limit of ours does that, but the system does where memory runs out.
    if (signal == SIGKILL) throw OutOfMemory("reading", name, "the process that read it was killed (out of memory?)");
    const bool no_memory = WIFEXITED(status) && WEXITSTATUS(status) == out_of_memory;
    if (no_memory && is_short_of(memory))
        throw OutOfMemory("reading", name, "takes more memory than this process may have (--memory, ulimit)");
    const bool no_time = signal == SIGXCPU || signal == SIGALRM;
    const std::string more =
        std::string("takes more ") + (no_memory ? "memory" : "time") + " than a file of its size can need";
    if (turn == Turn::ours)
        throw std::logic_error("reading " + name + ": render2mpeg " +
                               (no_memory || no_time ? "itself " + more : std::string("itself crashes on it")) +
                               "; this is a fault of the program, not of the file");
    if (no_memory) throw OutOfMemory("reading", name, more + ": it is damaged");
    throw core::Error("reading", name, no_time ? more + ": it is damaged" : "its parser crashed: the file is damaged");
}

int wait_for(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

}  // namespace

TrialLimits limits_for(std::uintmax_t file_size) {
    // chosen: twice the memory and twelve times the seconds of the largest need seen (docs/fits/memory.md).
    constexpr std::uintmax_t least_memory = std::uintmax_t{1} << 30, memory_per_byte = 60;
    constexpr unsigned least_seconds = 3, seconds_per_hundred_million = 60;
    const auto seconds = least_seconds + static_cast<unsigned>(seconds_per_hundred_million * file_size / 100'000'000);
    return {least_memory + memory_per_byte * file_size, seconds, 10 * seconds};
}

/// Whose turn it is, where parent and child both see it, whatever becomes of the child.
class ChildTrial::SharedTurn {
  public:
    SharedTurn() : place_(mmap(nullptr, sizeof(Turn), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {}
    ~SharedTurn() {
        if (place_ != MAP_FAILED) munmap(place_, sizeof(Turn));
    }
    SharedTurn(const SharedTurn&) = delete;
    SharedTurn& operator=(const SharedTurn&) = delete;

    Turn now() const { return place_ == MAP_FAILED ? Turn::parser : *static_cast<volatile Turn*>(place_); }
    void take(Turn turn) const {
        if (place_ != MAP_FAILED) *static_cast<volatile Turn*>(place_) = turn;
    }

  private:
    void* place_;
};

ChildTrial::ChildTrial(std::string name, const TrialLimits& limits, const Reading& reading)
    : name_(std::move(name)), memory_(limits.memory), turn_(std::make_unique<SharedTurn>()) {
    int ends[2];
    if (pipe(ends) != 0) throw core::Error("reading", name_, "the system gives no pipe to a child process");
    const pid_t parent = getpid();
    wait_for_others_to_sleep();
    child_ = fork();
    if (child_ == 0) {
        follow(parent);
        close(ends[0]);
        live_as_child(
            reading, limits, [this](Turn turn) { turn_->take(turn); }, ends[1]);
    }
    close(ends[1]);
    pipe_ = ends[0];
    if (child_ > 0) return;
    close(pipe_);
    throw core::Error("reading", name_, "the system gives no child process");
}

ChildTrial::~ChildTrial() {
    if (child_ > 0) {
        kill(child_, SIGKILL);
        wait_for(child_);
    }
    if (pipe_ >= 0) close(pipe_);
}

ChildTrial::Told ChildTrial::told() {
    EXPECTS(child_ > 0);
    std::string text = text_of_child(pipe_);
    const int status = wait_for(child_);
    child_ = -1;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {false, std::move(text)};
    if (WIFEXITED(status) && WEXITSTATUS(status) == refused) return {true, std::move(text)};
    tell_death(name_, status, turn_->now(), memory_);
}

void try_in_child(const std::filesystem::path& file, const std::function<void(const TakeTurns&)>& reading) {
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(file, failure);
    ChildTrial trial(file.string(), limits_for(failure ? 0 : size), [&](const TakeTurns& take_turns) {
        reading(take_turns);
        return std::string();
    });
    const ChildTrial::Told told = trial.told();
    if (told.refused) throw core::Error(told.text);
}

}  // namespace render2mpeg::scene
