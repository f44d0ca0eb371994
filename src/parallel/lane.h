#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

/// What the loops of this part share; nobody else includes it.
namespace render2mpeg::parallel {

/// What one thread of run_lanes() does, with the tasks of its loops; or what the process does outside of lanes.
struct Lane {
    std::atomic<const std::function<bool()>*> stop{nullptr};  ///< of the innermost StopWhen
    std::atomic<std::int64_t> nanoseconds{0};                 ///< CPU so far, but for what runs now
};

/// Lane of the calling thread.
Lane& present_lane();

/// Lets the calling thread work for a lane while it lives, and counts its CPU time there. Costs nothing where it did
/// already.
class InLane {
  public:
    explicit InLane(Lane& lane);
    ~InLane();
    InLane(const InLane&) = delete;
    InLane& operator=(const InLane&) = delete;

  private:
    Lane& before_;
};

}  // namespace render2mpeg::parallel
