#pragma once

#include <array>
#include <cstddef>

#include "parallel/lanes.h"
#include "renderer/base/plan.h"

namespace render2mpeg::renderer {

/// CPU seconds by pass.
class PassTimes {
  public:
    double& operator[](Pass pass) { return seconds_[static_cast<std::size_t>(pass)]; }
    double operator[](Pass pass) const { return seconds_[static_cast<std::size_t>(pass)]; }

  private:
    std::array<double, static_cast<std::size_t>(Pass::count)> seconds_{};
};

/// Adds the CPU time of its life to a row: its lane's (parallel/lanes.h).
class Stopwatch {
  public:
    explicit Stopwatch(double& row) : row_(row), start_(parallel::lane_seconds()) {}
    ~Stopwatch() { row_ += parallel::lane_seconds() - start_; }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

  private:
    double& row_;
    double start_;
};

}  // namespace render2mpeg::renderer
