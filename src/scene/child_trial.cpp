#include "scene/child_trial.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <new>
#include <string>

#include "core/error.h"

namespace render2mpeg::scene {
namespace {

constexpr int refused = 1, out_of_memory = 2, crashed = 3;

/// What a parser may take for a file of this size.
struct Limits {
    std::uintmax_t memory = 0;   ///< bytes more than this process holds now
    unsigned seconds = 0;        ///< of processor time
    unsigned clock_seconds = 0;  ///< for what waits: a busy machine makes others wait, too
};

Limits limits_for(std::uintmax_t file_size) {
    // chosen: the largest need seen is 30 bytes of memory per byte of a binary file and 5 s per 100 MB of text; files
    // that say 10^9 where they hold ten need 10^10 bytes or minutes, and some of 200 bytes never end. Tried 10 .. 100
    // bytes, 3 .. 60 s.
    constexpr std::uintmax_t least_memory = std::uintmax_t{1} << 30, memory_per_byte = 60;
    constexpr unsigned least_seconds = 3, seconds_per_hundred_million = 60;
    const auto seconds = least_seconds + static_cast<unsigned>(seconds_per_hundred_million * file_size / 100'000'000);
    return {least_memory + memory_per_byte * file_size, seconds, 10 * seconds};
}

std::uintmax_t address_space_now() {
    std::uintmax_t pages = 0;
    if (std::FILE* statm = std::fopen("/proc/self/statm", "r")) {
        if (std::fscanf(statm, "%ju", &pages) != 1) pages = 0;
        std::fclose(statm);
    }
    return pages * static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
}

void limit(const Limits& limits) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    // Sanitizers reserve more address space than there is memory; they go without this limit.
    const rlimit memory{limits.memory + address_space_now(), limits.memory + address_space_now()};
    setrlimit(RLIMIT_AS, &memory);
#endif
    const rlimit time{limits.seconds, limits.seconds + 1};
    setrlimit(RLIMIT_CPU, &time);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    alarm(limits.clock_seconds);
}

/// The child's whole life: never returns. A refusal goes to `pipe` as text.
[[noreturn]] void live_as_child(const std::function<void()>& reading, const Limits& limits, int pipe) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGABRT, SIGALRM}) std::signal(signal, SIG_DFL);
    limit(limits);
    int status = 0;
    try {
        reading();
    } catch (const core::Error& error) {
        const std::string text = error.what();
        status = write(pipe, text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? refused : out_of_memory;
    } catch (const std::bad_alloc&) {
        status = out_of_memory;
    } catch (...) {
        status = crashed;
    }
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

}  // namespace

void try_in_child(const std::filesystem::path& file, const std::function<void()>& reading) {
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(file, failure);
    const Limits limits = limits_for(failure ? 0 : size);
    int ends[2];
    if (pipe(ends) != 0) throw core::Error("reading", file.string(), "the system gives no pipe to a child process");
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        live_as_child(reading, limits, ends[1]);
    }
    close(ends[1]);
    const std::string text = child > 0 ? text_of_child(ends[0]) : std::string();
    close(ends[0]);
    if (child < 0) throw core::Error("reading", file.string(), "the system gives no child process");

    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
    if (WIFEXITED(status) && WEXITSTATUS(status) == refused) throw core::Error(text);
    if (WIFEXITED(status) && WEXITSTATUS(status) == out_of_memory)
        throw core::Error("reading", file.string(),
                          "takes more memory than a file of its size can need: it is damaged");
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (signal == SIGXCPU || signal == SIGALRM || signal == SIGKILL)
        throw core::Error("reading", file.string(), "takes more time than a file of its size can need: it is damaged");
    throw core::Error("reading", file.string(), "its parser crashed: the file is damaged");
}

}  // namespace render2mpeg::scene
