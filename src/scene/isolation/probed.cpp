#include "scene/isolation/probed.h"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string_view>

namespace render2mpeg::scene {
namespace {

constexpr std::string_view flag = "--probe";

rlim_t seconds_now() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<rlim_t>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec);
}

/// Limits turn by turn, within those of the process.
class TurnLimits {
  public:
    explicit TurnLimits(const ProbeLimits& limits) : limits_(limits) {}

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
    static rlim_t limit_of(__rlimit_resource resource) {
        rlimit both{};
        return getrlimit(resource, &both) == 0 ? both.rlim_cur : RLIM_INFINITY;
    }
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

bool write_all(std::string_view text) {
    while (!text.empty()) {
        const ssize_t n = write(text_pipe, text.data(), text.size());
        if (n < 0 && errno != EINTR) return false;
        if (n > 0) text.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
}

}  // namespace

std::uintmax_t address_space_now() {
    std::uintmax_t pages = 0;
    if (std::FILE* statm = std::fopen("/proc/self/statm", "re")) {
        if (std::fscanf(statm, "%ju", &pages) != 1) pages = 0;
        std::fclose(statm);
    }
    return pages * static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
}

std::vector<std::string> probe_words(const ProbeLimits& limits) {
    return {std::string(flag), std::to_string(getpid()), std::to_string(limits.memory), std::to_string(limits.seconds),
            std::to_string(limits.clock_seconds)};
}

void write_from_probe(const std::string& text) {
    if (!write_all(text)) _exit(probe_crashed);
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

    // Libraries print to standard output.
    text_pipe = dup(STDOUT_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    const TurnLimits limits({std::strtoumax(argv[3], nullptr, 10),
                             static_cast<unsigned>(std::strtoul(argv[4], nullptr, 10)),
                             static_cast<unsigned>(std::strtoul(argv[5], nullptr, 10))});
    int status = 0;
    std::string text;
    try {
        text = reading->second({words.begin() + own_words, words.end()}, [&](Turn turn) {
            const char mark = turn_mark(turn);
            if (write(probe_turns, &mark, 1) != 1) _exit(probe_crashed);
            limits.begin_turn();
        });
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
