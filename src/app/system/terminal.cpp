#include "app/system/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace render2mpeg::app {
namespace {

int columns_of(int descriptor) {
    winsize size{};
    return ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

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
