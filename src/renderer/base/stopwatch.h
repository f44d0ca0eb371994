#pragma once

#include <array>
#include <cstddef>
#include <ctime>

#include "renderer/base/plan.h"

namespace render2mpeg::renderer {

/// CPU seconds of this process, all threads.
inline double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// CPU seconds by pass.
class PassTimes {
  public:
    double& operator[](Pass pass) { return seconds_[static_cast<std::size_t>(pass)]; }
    double operator[](Pass pass) const { return seconds_[static_cast<std::size_t>(pass)]; }

  private:
    std::array<double, static_cast<std::size_t>(Pass::count)> seconds_{};
};

/// Adds the CPU time of its life to a row.
class Stopwatch {
  public:
    explicit Stopwatch(double& row) : row_(row), start_(cpu_seconds()) {}
    ~Stopwatch() { row_ += cpu_seconds() - start_; }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

  private:
    double& row_;
    double start_;
};

}  // namespace render2mpeg::renderer
