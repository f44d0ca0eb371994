#include "app/interrupt.h"

#include <unistd.h>

#include <csignal>

namespace render2mpeg::app {
namespace {

volatile std::sig_atomic_t interrupts = 0;

// Status 128 + signal, as shells report a process that a signal ended.
void on_signal(int signal) {
    interrupts = interrupts + 1;
    if (interrupts > 1) _exit(128 + signal);
}

}  // namespace

InterruptGuard::InterruptGuard() {
    interrupts = 0;
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

bool InterruptGuard::requested() {
    return interrupts > 0;
}

}  // namespace render2mpeg::app
