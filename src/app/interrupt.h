#pragma once

namespace render2mpeg::app {

/// While it lives, the first SIGINT or SIGTERM only raises a flag, and a second one ends the process at once.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    static bool requested();
};

}  // namespace render2mpeg::app
