#include "app/system/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <cstring>

namespace render2mpeg::app {
namespace {

volatile std::sig_atomic_t interrupts = 0;
volatile std::sig_atomic_t last_signal = SIGINT;
volatile std::sig_atomic_t silent = 0;

// A frame may take minutes: say at once that the wish was heard.
constexpr const char* heard = "\nfinishing the frame at hand; interrupt again to stop at once\n";

void on_signal(int signal) {
    interrupts = interrupts + 1;
    last_signal = signal;
    if (interrupts > 1) _exit(128 + signal);
    if (silent == 0 && write(STDERR_FILENO, heard, std::strlen(heard)) < 0) return;
}

}  // namespace

InterruptGuard::InterruptGuard(bool quiet) {
    interrupts = 0;
    silent = quiet ? 1 : 0;
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    // The terminal was closed; nohup says that it is to go on all the same.
    if (std::signal(SIGHUP, on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    if (std::signal(SIGHUP, SIG_DFL) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

bool InterruptGuard::requested() {
    return interrupts > 0;
}

int InterruptGuard::status() {
    return 128 + last_signal;
}

}  // namespace render2mpeg::app
