#include "app/system/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace render2mpeg::app {
namespace {

/// Handlers may write lock-free atomics only.
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);
std::atomic<int> interrupts{0}, last_signal{SIGINT};
std::atomic<bool> silent{false};

constexpr const char* heard = "\nstopping; interrupt again to stop at once\n";

void on_signal(int signal) {
    const int interrupted_errno = errno;  // of the call that the signal came into
    last_signal = signal;
    if (interrupts.fetch_add(1) > 0) _exit(128 + signal);
    if (!silent) {
        const ssize_t written = write(STDERR_FILENO, heard, std::strlen(heard));
        static_cast<void>(written);  // nobody listens
    }
    errno = interrupted_errno;
}

}  // namespace

InterruptGuard::InterruptGuard(bool quiet) {
    interrupts = 0;
    silent = quiet;
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    for (std::size_t i = 0; i < signals.size(); ++i) {
        sigaction(signals[i], nullptr, &before_[i]);
        if (before_[i].sa_handler != SIG_IGN) sigaction(signals[i], &action, nullptr);
    }
}

InterruptGuard::~InterruptGuard() {
    for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before_[i], nullptr);
}

bool InterruptGuard::requested() {
    return interrupts > 0;
}

int InterruptGuard::status() {
    return 128 + last_signal;
}

}  // namespace render2mpeg::app
