#pragma once
// The price of light: the share of what coding hides that light may err by, so that a film loses as much as is asked.
#include "core/radiance.h"
#include "perceptual/light_loss.h"
#include "perceptual/visibility_model.h"

namespace render2mpeg::app {

/// Share for a chunk's first picture, before it is lit: from a rough look at it, and the noise of the light
/// by which it was seen, which the first rays of points found. `loss`: dB > 0.
float expected_share(const perceptual::VisibilityModel& model, const perceptual::TemporalState& rough,
                     const core::Radiance& light, double loss);

/// What a picture loses by the noise of its light, and the share by which the next of its kind lose what is asked.
struct LightLoss {
    double of_picture = 0;  ///< dB
    float share = 0;
};

/// Share that pictures of a kind have, as they tell what they lose. Where a finer one has not lowered the loss by half
/// of what it should (of noise that no price moves), the share before it is the least from then on.
class SharePrice {
  public:
    SharePrice() = default;
    explicit SharePrice(float share) : share_(share) {}

    bool is_known() const { return share_ > 0; }
    float share() const { return share_; }
    /// `lit_by`: the share that the picture's light had.
    void learn(const LightLoss& found, float lit_by);

    template <class A>
    friend void archive(A& a, SharePrice& p) {
        auto& [share, least, lit_by, loss] = p;
        a(share, least, lit_by, loss);
    }

  private:
    float share_ = 0, least_ = 0;
    float lit_by_ = 0;  ///< of the last picture; 0: none
    double loss_ = 0;   ///< its own, dB
};

/// `blocks`: as the picture is coded; `share`: that it was lit by.
LightLoss measure_loss(perceptual::CodedBlocks blocks, const perceptual::PixelLight& seen, const core::Radiance& light,
                       const perceptual::InverseLuma& display, const perceptual::CodingPlan& coding, double loss,
                       float share);

}  // namespace render2mpeg::app
