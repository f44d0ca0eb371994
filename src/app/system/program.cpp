#include "app/system/program.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "core/error.h"

namespace render2mpeg::app {

bool is_installed(const std::string& program) {
    if (program.find('/') != std::string::npos) return access(program.c_str(), X_OK) == 0;
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
    return false;
}

Finished run_program(std::vector<std::string> words, Output output) {
    const bool caught = output == Output::caught;
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    int ends[2] = {-1, -1};
    if (caught && pipe2(ends, O_CLOEXEC) != 0) throw core::Error("running", words[0], std::strerror(errno));
    const pid_t child = fork();
    if (child == 0) {
        if (caught) {
            setpgid(0, 0);
            dup2(ends[1], 1);
            dup2(ends[1], 2);
        }
        execvp(arguments[0], arguments.data());
        _exit(127);
    }
    Finished finished;
    if (caught) close(ends[1]);
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
    while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    finished.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    for (const timeval& t : {usage.ru_utime, usage.ru_stime})
        finished.seconds += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    return finished;
}

}  // namespace render2mpeg::app
