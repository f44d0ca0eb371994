#pragma once
// Ends a run after its frame at the first signal, at once at the second.
namespace render2mpeg::app {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP only raises a flag (and says so, unless `quiet`), and a second
/// one ends the process at once.
class InterruptGuard {
  public:
    explicit InterruptGuard(bool quiet);
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    static bool requested();
    /// Exit status of an interrupted run, as shells report a process that the signal ended: 128 + signal.
    static int status();
};

}  // namespace render2mpeg::app
