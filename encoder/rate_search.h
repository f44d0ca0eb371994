#pragma once
// Brings quantisers to a wanted number of bits by coding with them again.
#include <limits>
#include <optional>

namespace render2mpeg::encoder {

/// The factor on all quantisers of a film, or of a part of it, with which that comes to its bits: false position
/// (Illinois) on logarithms, from what was coded with other factors.
class RateSearch {
  public:
    /// Ends within a share `near` of the bits, or after `most_tries` (1..). chosen: a half per cent, or the best of
    /// eight: whole quantisers of short films come no nearer.
    explicit RateSearch(double near = 0.005, int most_tries = 8);
    /// One that begins where this one is, with the slope that it found: for coding that follows quantisers alike.
    RateSearch onwards(double near, int most_tries) const;
    /// To be tried next; 1 at first.
    double factor() const;
    /// Takes the bits that came of factor(), over those wanted, both above 0. True: no other factor came nearer.
    bool try_ratio(double ratio);
    /// Whether another try is worth it.
    bool goes_on() const;

  private:
    struct Tried {
        double factor, excess;  ///< logarithms
    };
    double near_;
    int most_tries_;
    std::optional<Tried> above_, below_, last_;
    double factor_ = 0, closest_ = std::numeric_limits<double>::infinity();
    double slope_ = 0.9;         ///< bits fall with this power of the quantiser
    int tries_ = 0, alike_ = 0;  ///< alike: tries in turn that changed nothing
};

}  // namespace render2mpeg::encoder
