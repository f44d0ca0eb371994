#pragma once
// Time to go.
#include <cstdint>
#include <optional>
#include <vector>

namespace render2mpeg::app {

/// Time to go by the frames so far. Frames that begin light anew, B pictures and all others count apart.
class Pace {
  public:
    /// `firsts`: frames that begin light anew, ascending: those of chunks, and after cuts.
    explicit Pace(std::vector<std::int64_t> firsts = {}) : firsts_(std::move(firsts)) {}

    /// `type`: I, P, B; '-': not coded.
    void add(double seconds, char type = '-');
    /// Frames done before.
    void skip(std::int64_t frames) { done_ += frames; }

    /// Seconds up to frame `total`, of which the present one took `spent`; > 0 while any are left. None where nothing
    /// is known.
    std::optional<double> left(std::int64_t total, double spent = 0) const;
    /// Of later frames; 0: unknown.
    double per_second() const;

  private:
    /// Seconds of one kind of frames, in order.
    using Kind = std::vector<double>;

    std::int64_t firsts_from(std::int64_t frame, std::int64_t total) const;
    /// Share of B pictures among later frames.
    double share_of_b() const;
    /// Mean of so many later frames; 0: unknown.
    double later(double frames) const;

    std::vector<std::int64_t> firsts_;
    std::int64_t done_ = 0;
    double first_seconds_ = 0;
    int first_count_ = 0;
    Kind b_, others_;
    std::vector<int> rounds_;  ///< frames from one that is no B picture to the next
    int run_ = 0;              ///< B pictures since
};

}  // namespace render2mpeg::app
