#include "app/system/terminal.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/text.h"

namespace render2mpeg::app {
namespace {

int columns_of(int descriptor) {
    winsize size{};
    return ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

void hold_standard_descriptors() {
    // Each gets the lowest free number: its own.
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF)
            open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

void print_line(std::string_view text) {
    std::fputs((core::printable(text) + "\n").c_str(), stderr);
}

void print_lines(std::string_view text) {
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        print_line(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

void print_error(std::string_view text) {
    print_line("render2mpeg: " + std::string(text));
}

bool can_rewrite_errors() {
    const char* kind = std::getenv("TERM");
    return isatty(STDERR_FILENO) != 0 && kind != nullptr && std::string_view(kind) != "dumb";
}

int columns_of_errors() {
    return columns_of(STDERR_FILENO);
}

int columns_of_output() {
    return columns_of(STDOUT_FILENO);
}

}  // namespace render2mpeg::app
