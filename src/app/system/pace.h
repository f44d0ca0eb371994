#pragma once
// Time to go.
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace render2mpeg::app {

/// Time to go: frames that begin light anew as all of these so far, others as the last few of them.
class Pace {
  public:
    /// `firsts`: frames that begin light anew, ascending: those of chunks, and after cuts.
    explicit Pace(std::vector<std::int64_t> firsts = {}) : firsts_(std::move(firsts)) {}

    void add(double seconds);
    /// Frames done before.
    void skip(std::int64_t frames) { done_ += frames; }

    /// Seconds up to frame `total`, of which the present one took `spent`; > 0 while any are left. None where nothing
    /// is known.
    std::optional<double> left(std::int64_t total, double spent = 0) const;
    /// Of later frames; 0: unknown.
    double per_second() const;

  private:
    std::int64_t firsts_from(std::int64_t frame, std::int64_t total) const;
    /// Mean of recent later frames; 0: unknown.
    double later() const;

    std::vector<std::int64_t> firsts_;
    std::int64_t done_ = 0;
    double first_seconds_ = 0;
    int first_count_ = 0;
    std::deque<double> recent_;
};

}  // namespace render2mpeg::app
