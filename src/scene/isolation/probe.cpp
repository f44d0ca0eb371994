#include "scene/isolation/probe.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/module.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

/// Empty where there is none.
fs::path program() {
    if (const char* named = std::getenv("RENDER2MPEG_PROGRAM"); named != nullptr && *named != '\0') return named;
    const fs::path self = core::program_file();
    if (self.empty()) return {};
    std::error_code failure;
    if (self.filename() == "render2mpeg") return self;
    for (const fs::path& folder : {self.parent_path(), self.parent_path().parent_path()})
        if (fs::is_regular_file(folder / "render2mpeg", failure)) return folder / "render2mpeg";
    return {};
}

/// A descriptor, closed in the end and not inherited.
struct Descriptor {
    explicit Descriptor(int number) : value(number) {}
    ~Descriptor() {
        if (value >= 0) close(value);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int release() { return std::exchange(value, -1); }

    int value;
};

[[noreturn]] void fail(int failure) {
    const std::string cause = std::strerror(failure);
    throw core::Error("starting", program().string(),
                      "a process that reads files cannot begin: " + cause +
                          (failure == EAGAIN ? " (too many processes? ulimit -u)" : ""));
}

/// A memory file with `bytes`.
int file_of(std::span<const std::byte> bytes) {
    Descriptor file(memfd_create("input", MFD_CLOEXEC));
    if (file.value < 0) fail(errno);
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t n = pwrite(file.value, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
        if (n < 0 && errno != EINTR) fail(errno);
        if (n > 0) done += static_cast<std::size_t>(n);
    }
    return file.release();
}

/// Address space of this process in bytes; 0: unknown.
std::uintmax_t address_space_now() {
    std::uintmax_t pages = 0;
    if (std::FILE* statm = std::fopen("/proc/self/statm", "re")) {
        if (std::fscanf(statm, "%ju", &pages) != 1) pages = 0;
        std::fclose(statm);
    }
    return pages * static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
}

rlim_t limit_of(__rlimit_resource resource) {
    rlimit both{};
    return getrlimit(resource, &both) == 0 ? both.rlim_cur : RLIM_INFINITY;
}

/// Whether this process itself is limited to less memory than a probe (`ulimit`, `--memory`).
bool is_short_of(std::uintmax_t memory) {
    const rlim_t all = limit_of(RLIMIT_AS), own = limit_of(RLIMIT_DATA);
    return (all != RLIM_INFINITY && all < memory + address_space_now()) || (own != RLIM_INFINITY && own < memory);
}

/// Ends a probe and what it started, its group of processes.
void kill_all(pid_t child) {
    kill(-child, SIGKILL);
}

int wait_for(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

/// Reads to the end; false where `give_up` said so.
bool read_all(int pipe, std::string& text, const std::function<bool()>& give_up) {
    constexpr int look_every_ms = 50;
    std::array<char, 4096> buffer;
    for (;;) {
        pollfd ready{pipe, POLLIN, 0};
        if (give_up && give_up()) return false;
        if (poll(&ready, 1, give_up ? look_every_ms : -1) <= 0) continue;
        const ssize_t n = read(pipe, buffer.data(), buffer.size());
        if (n > 0) text.append(buffer.data(), static_cast<std::size_t>(n));
        if (n == 0 || (n < 0 && errno != EINTR)) return true;
    }
}

/// First of what a probe writes, once it understands what it is to read.
constexpr char begun = '\6';

/// Why a probe ended before it began to read.
std::string why_not_begun(int status) {
    const std::string who = program().string() + ", which should read it in a process of its own, ";
    if (WIFSIGNALED(status)) return who + "was ended by signal " + std::to_string(WTERMSIG(status)) + " as it started";
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    if (code == probe_crashed) return who + "is of another version";
    return who + "does not start (exit status " + std::to_string(code) + ")";
}

ProbeEnd::How how_ended(int status) {
    using enum ProbeEnd::How;
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (signal == SIGKILL) return killed;
    if (signal == SIGXCPU || signal == SIGALRM) return out_of_time;
    if (!WIFEXITED(status)) return crashed;
    switch (WEXITSTATUS(status)) {
        case 0:
            return read;
        case probe_refused:
            return refused;
        case probe_out_of_memory:
            return out_of_memory;
        default:
            return crashed;
    }
}

/// Starts the program with these descriptors as 0 and 1.
pid_t spawn(std::vector<std::string> words, int input, int text) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, text, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    // Interrupts are the parent's.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t blocked, usual;
    sigemptyset(&blocked);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&blocked, signal);
    sigemptyset(&usual);
    for (const int signal : {SIGSEGV, SIGABRT, SIGALRM, SIGXCPU}) sigaddset(&usual, signal);
    posix_spawnattr_setsigmask(&attributes, &blocked);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    pid_t child = -1;
    const int failure = posix_spawn(&child, program().c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) fail(failure);
    return child;
}

constexpr std::string_view flag = "--probe";

rlim_t seconds_now() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<rlim_t>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec);
}

/// Limits that begin anew, within those of the process.
class RenewedLimits {
  public:
    explicit RenewedLimits(const ProbeLimits& limits) : limits_(limits) {}

    void begin() const {
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
    static void lower(__rlimit_resource resource, rlim_t limit) {
        rlimit both{};
        if (getrlimit(resource, &both) != 0) return;
        both.rlim_cur = std::min(limit, both.rlim_max);
        setrlimit(resource, &both);
    }

    ProbeLimits limits_;
    rlim_t memory_ = limit_of(RLIMIT_AS), seconds_ = limit_of(RLIMIT_CPU);
};

int text_pipe = -1;
rlim_t most_memory = RLIM_INFINITY;  ///< of the parent

bool write_all(std::string_view text) {
    while (!text.empty()) {
        const ssize_t n = write(text_pipe, text.data(), text.size());
        if (n < 0 && errno != EINTR) return false;
        if (n > 0) text.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
}

}  // namespace

ProbeLimits limits_for(std::uintmax_t file_size) {
    // chosen: the largest need seen is 30 bytes of memory per byte of a binary file and 5 s per 100 MB of text; files
    // that say 10^9 where they hold ten need 10^10 bytes or minutes, and some of 200 bytes never end. Tried 10 .. 100
    // bytes, 3 .. 60 s.
    constexpr std::uintmax_t least_memory = std::uintmax_t{1} << 30, memory_per_byte = 60;
    constexpr unsigned least_seconds = 3, seconds_per_hundred_million = 60;
    const auto seconds = least_seconds + static_cast<unsigned>(seconds_per_hundred_million * file_size / 100'000'000);
    return {least_memory + memory_per_byte * file_size, seconds, 10 * seconds};
}

ProbeLimits limits_for(const fs::path& file) {
    std::error_code failure;
    const std::uintmax_t size = fs::file_size(file, failure);
    return limits_for(failure ? std::uintmax_t{0} : size);
}

bool Probe::is_possible() {
    return !program().empty();
}

Probe::Probe(const ProbeLimits& limits, const std::vector<std::string>& words, std::span<const std::byte> input) {
    int text[2];
    if (pipe2(text, O_CLOEXEC) != 0) fail(errno);
    Descriptor text_end(text[0]), text_begin(text[1]);
    Descriptor read_from(file_of(input));
    std::vector<std::string> all{program().string(),
                                 std::string(flag),
                                 std::to_string(getpid()),
                                 std::to_string(limits.memory),
                                 std::to_string(limits.seconds),
                                 std::to_string(limits.clock_seconds)};
    all.insert(all.end(), words.begin(), words.end());
    child_ = spawn(std::move(all), read_from.value, text[1]);
    text_ = text_end.release();
    input_ = read_from.release();
}

Probe::~Probe() {
    if (child_ > 0) {
        kill_all(child_);
        wait_for(child_);
    }
    for (const int open : {text_, input_})
        if (open >= 0) close(open);
}

int Probe::take_input() {
    EXPECTS(child_ < 0 && input_ >= 0);
    return std::exchange(input_, -1);
}

ProbeEnd Probe::end(const std::function<bool()>& give_up) {
    EXPECTS(child_ > 0);
    ProbeEnd end;
    const bool ended = read_all(text_, end.text, give_up);
    if (!ended) kill_all(child_);
    const int status = wait_for(child_);
    child_ = -1;
    end.how = ended ? how_ended(status) : ProbeEnd::How::given_up;
    const bool has_begun = end.text.starts_with(begun);
    if (has_begun) end.text.erase(0, 1);
    if (ended && !has_begun && end.how != ProbeEnd::How::killed)
        end = {ProbeEnd::How::not_begun, why_not_begun(status)};
    return end;
}

std::string text_of(ProbeEnd end, const std::string& name, const ProbeLimits& limits) {
    using How = ProbeEnd::How;
    if (end.how == How::read || end.how == How::given_up) return std::move(end.text);
    if (end.how == How::refused) throw core::Error(end.text);
    if (end.how == How::not_begun) throw core::Error("reading", name, end.text);
    // Our limits do not kill, but the system's lack of memory does.
    if (end.how == How::killed)
        throw OutOfMemory("reading", name, "the process that read it was killed (out of memory?)");
    const bool no_memory = end.how == How::out_of_memory, no_time = end.how == How::out_of_time;
    if (no_memory && is_short_of(limits.memory))
        throw OutOfMemory("reading", name, "takes more memory than this process may have (--memory, ulimit)");
    const std::string more =
        std::string("takes more ") + (no_memory ? "memory" : "time") + " than a file of its size can need";
    if (no_memory) throw OutOfMemory("reading", name, more + ": it is damaged");
    throw core::Error("reading", name, no_time ? more + ": it is damaged" : "reading it crashed: the file is damaged");
}

std::string read_in_probe(const std::vector<std::string>& words, const std::string& name, const ProbeLimits& limits,
                          const std::function<bool()>& give_up) {
    return text_of(Probe(limits, words).end(give_up), name, limits);
}

void write_from_probe(const std::string& text) {
    if (!write_all(text)) _exit(probe_crashed);
}

void allow_more_memory(std::uintmax_t bytes) {
    rlimit both{};
    if (getrlimit(RLIMIT_AS, &both) != 0 || both.rlim_cur == RLIM_INFINITY) return;
    both.rlim_cur = std::min({both.rlim_cur + bytes, both.rlim_max, most_memory});
    setrlimit(RLIMIT_AS, &both);
}

bool is_probe(int argc, char** argv) {
    return argc > 1 && argv[1] == flag;
}

void live_as_probe(int argc, char** argv, const std::map<std::string, ProbedReading>& readings) {
    // Interrupts are the parent's, and the probe ends with it.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const std::vector<std::string> words(argv, argv + argc);
    constexpr std::size_t own_words = 7;  // with the program and the kind
    if (words.size() < own_words || getppid() != std::atoi(argv[2])) _exit(probe_crashed);
    const auto reading = readings.find(words[own_words - 1]);
    if (reading == readings.end()) _exit(probe_crashed);

    most_memory = limit_of(RLIMIT_AS);
    // Libraries print to standard output.
    text_pipe = dup(STDOUT_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    write_from_probe({begun});
    const RenewedLimits limits({std::strtoumax(argv[3], nullptr, 10),
                                static_cast<unsigned>(std::strtoul(argv[4], nullptr, 10)),
                                static_cast<unsigned>(std::strtoul(argv[5], nullptr, 10))});
    int status = 0;
    std::string text;
    try {
        text = reading->second({words.begin() + own_words, words.end()}, [&] { limits.begin(); });
    } catch (const core::Error& error) {
        // Libraries report a lack of memory in many ways; malloc() has one.
        status = errno == ENOMEM ? probe_out_of_memory : probe_refused;
        text = error.what();
    } catch (const std::bad_alloc&) {
        status = probe_out_of_memory;
    } catch (...) {
        status = probe_crashed;
    }
    if (!write_all(text)) status = probe_crashed;
    _exit(status);
}

}  // namespace render2mpeg::scene
