// cpu_seconds NAME SECONDS PROGRAM [WORD...]: runs a test and appends "NAME <CPU seconds> <clock seconds> <exit
// status>" to the file that RENDER2MPEG_TEST_TIMES names, if any. CPU seconds are those of the program and of all
// processes that it or its children waited for; what serves it adds a line (RENDER2MPEG_TEST is NAME). A process that
// takes more than SECONDS of one processor is ended (SIGXCPU): a bound that holds on slow and on busy machines alike.
// "cpu_seconds --drawn NAME ..." is left out (exit status 77) where RENDER2MPEG_TEST_BUDGET is set and the tests in
// that file have taken as many CPU seconds.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

double seconds(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// One write of a whole line: tests that end together do not mix theirs.
void append(const char* file, const std::string& line) {
    if (std::FILE* out = std::fopen(file, "a")) {
        std::setvbuf(out, nullptr, _IOFBF, 4096);
        std::fputs(line.c_str(), out);
        std::fclose(out);
    }
}

/// CPU seconds of the tests that the file has so far.
double taken(const char* file) {
    double sum = 0;
    if (std::FILE* in = file != nullptr ? std::fopen(file, "r") : nullptr) {
        double cpu = 0;
        while (std::fscanf(in, "%*s %lf %*f %*d", &cpu) == 1) sum += cpu;
        std::fclose(in);
    }
    return sum;
}

}  // namespace

int main(int count, char** words) {
    const bool drawn = count > 1 && std::strcmp(words[1], "--drawn") == 0;
    if (drawn) ++words, --count;
    if (count < 4) {
        std::fputs("usage: cpu_seconds [--drawn] NAME SECONDS PROGRAM [WORD...]\n", stderr);
        return 2;
    }
    const char* budget = std::getenv("RENDER2MPEG_TEST_BUDGET");
    if (drawn && budget != nullptr && taken(std::getenv("RENDER2MPEG_TEST_TIMES")) >= std::atof(budget)) {
        std::printf("left out: the tests before it took the %s CPU seconds of this run\n", budget);
        return 77;
    }
    const auto begin = std::chrono::steady_clock::now();
    const pid_t child = fork();
    if (child == 0) {
        rlimit limit{};
        getrlimit(RLIMIT_CPU, &limit);
        const auto most = static_cast<rlim_t>(std::atoll(words[2]));
        if (most > 0 && (limit.rlim_cur == RLIM_INFINITY || most < limit.rlim_cur)) {
            limit.rlim_cur = most;
            setrlimit(RLIMIT_CPU, &limit);
        }
        setenv("RENDER2MPEG_TEST", words[1], 1);
        execv(words[3], words + 3);
        std::perror(words[3]);
        _exit(127);
    }
    int status = 0;
    rusage used{};
    if (child < 0 || wait4(child, &status, 0, &used) != child) {
        std::perror("cpu_seconds");
        return 1;
    }
    const std::chrono::duration<double> clock = std::chrono::steady_clock::now() - begin;
    const int left = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    if (left == 128 + SIGXCPU)
        std::fprintf(stderr, "cpu_seconds: %s was ended after %s CPU seconds\n", words[1], words[2]);
    if (const char* file = std::getenv("RENDER2MPEG_TEST_TIMES")) {
        char line[1024];
        std::snprintf(line, sizeof line, "%s %.2f %.2f %d\n", words[1], seconds(used.ru_utime) + seconds(used.ru_stime),
                      clock.count(), left);
        append(file, line);
    }
    return left;
}
