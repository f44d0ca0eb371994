#pragma once
// Learns by material whether glossy records pay.
#include <cstddef>
#include <cstdint>
#include <vector>

namespace render2mpeg::renderer {

/// Whether records are worth their while for the lobes of each material, learnt from frames in which they were tried: a
/// lobe may be wide and change little where nothing but the sky is near, or narrow amid a hundred lamps, and how much
/// may change is the tolerance's to say. A function of what was noted since `forget`.
class GlossyPayoff {
  public:
    /// Nothing is known: all materials are tried.
    void forget() { payoffs_.clear(); }

    /// Whether points of a material with a lobe take records in this frame.
    bool uses_cache(std::uint32_t material) const {
        return material >= payoffs_.size() || payoffs_[material].rests == 0;
    }

    /// Points of a material that took part in this frame: how many wanted light, and of how many records knew it.
    void note(std::uint32_t material, std::uint64_t asked, std::uint64_t served);

    /// A frame is over.
    void judge();

    std::size_t bytes() const { return payoffs_.capacity() * sizeof(Payoff); }

  private:
    struct Payoff {
        double asked = 0, served = 0;                 ///< of frames that count, each half as much as the next
        std::uint64_t asked_now = 0, served_now = 0;  ///< of this frame
        int frames = 0;                               ///< in which it took part since it was last tried
        int rests = 0;                                ///< frames for which it takes no records
    };
    std::vector<Payoff> payoffs_;  ///< by material
};

}  // namespace render2mpeg::renderer
