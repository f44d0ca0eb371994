#include "encoder_rd/ffmpeg_process.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"

namespace render2mpeg::bench {

Finished run_program(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);

    int ends[2];
    if (pipe(ends) != 0) throw core::Error("running " + words[0] + ": no pipe to be had");
    const pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], 1);
        dup2(ends[1], 2);
        close(ends[0]);
        execvp(arguments[0], arguments.data());
        _exit(127);
    }
    close(ends[1]);
    Finished finished;
    char buffer[4096];
    for (ssize_t n = 0; (n = ::read(ends[0], buffer, sizeof buffer)) > 0;)
        finished.text.append(buffer, static_cast<std::size_t>(n));
    close(ends[0]);
    int status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    if (child < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw core::Error("running " + words[0] + ": " + (finished.text.empty() ? "it failed" : finished.text));
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    finished.seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    return finished;
}

}  // namespace render2mpeg::bench
