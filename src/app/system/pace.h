#pragma once
// How long the rest of a run takes, by how long its frames took.
#include <cstdint>
#include <optional>
#include <vector>

namespace render2mpeg::app {

/// Reckons the time to go from recent frames. The first frame of a chunk takes more than others: it makes what later
/// ones use, so that it counts apart.
class Pace {
  public:
    /// `chunk`: frames of a chunk; 0: all are alike. `takes_turns`: the second frame of a chunk is a B picture.
    explicit Pace(std::int64_t chunk = 0, bool takes_turns = false) : chunk_(chunk), takes_turns_(takes_turns) {}

    /// The next frame took so many seconds.
    void add(double seconds);
    /// So many frames were done before, in a time that tells nothing.
    void skip(std::int64_t frames) { done_ += frames; }

    /// Seconds for the frames up to `total`, of which the frame at hand has taken `spent` already; above 0 as long as
    /// there are any. None where nothing is known at all.
    std::optional<double> left(std::int64_t total, double spent = 0) const;
    /// Frames per second, of those that are no chunk's first; 0: not known.
    double per_second() const;

  private:
    bool is_first(std::int64_t frame) const { return chunk_ > 0 && frame % chunk_ == 0; }
    /// The mean of the recent ones that are no chunk's first; 0: none is known.
    double recent() const;

    std::int64_t chunk_, done_ = 0;
    bool takes_turns_;
    std::vector<double> later_;
    double firsts_ = 0;  ///< seconds of chunks' first frames
    int first_count_ = 0;
};

}  // namespace render2mpeg::app
