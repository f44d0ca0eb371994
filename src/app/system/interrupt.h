#pragma once
// Ends a run after its frame at the first signal, at once at the second.

#include <array>
#include <csignal>

#include "core/error.h"

namespace render2mpeg::app {

/// What an interruption left undone: exit status 128 + signal.
class Interrupted : public core::Error {
  public:
    using core::Error::Error;
};

/// The first SIGINT, SIGTERM or SIGHUP raises a flag (with a message unless `quiet`), the second ends the process.
/// Ignored signals (`nohup`) stay ignored. One at a time.
class InterruptGuard {
  public:
    explicit InterruptGuard(bool quiet);
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    static bool requested();
    /// 128 + signal.
    static int status();

  private:
    static constexpr std::array<int, 3> signals{SIGINT, SIGTERM, SIGHUP};
    std::array<struct sigaction, signals.size()> before_{};
};

}  // namespace render2mpeg::app
