#pragma once
// Ends a run after its frame at the first signal, at once at the second.

#include <array>
#include <csignal>

namespace render2mpeg::app {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP only raises a flag (and says so, unless `quiet`), and a second
/// one ends the process at once. Signals that the process was started to ignore (`nohup`, a job in the background of a
/// script) stay ignored. One at a time.
class InterruptGuard {
  public:
    explicit InterruptGuard(bool quiet);
    /// Signals are treated as before.
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    static bool requested();
    /// Exit status of an interrupted run, as shells report a process that the signal ended: 128 + signal.
    static int status();

  private:
    static constexpr std::array<int, 3> signals{SIGINT, SIGTERM, SIGHUP};
    std::array<struct sigaction, signals.size()> before_{};
};

}  // namespace render2mpeg::app
