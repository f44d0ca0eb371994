#pragma once
// Brings quantisers to a wanted number of bits by coding with them again.
#include <limits>
#include <optional>

namespace render2mpeg::encoder {

/// The factor on all quantisers of a film, or of a part of it, with which that comes to its bits: false position
/// (Illinois) on logarithms, from what was coded with other factors.
class RateSearch {
  public:
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
    std::optional<Tried> above_, below_, last_;
    double factor_ = 0, closest_ = std::numeric_limits<double>::infinity();
    double slope_ = 0.9;         ///< bits fall with this power of the quantiser
    int tries_ = 0, alike_ = 0;  ///< alike: tries in turn that changed nothing
};

}  // namespace render2mpeg::encoder
