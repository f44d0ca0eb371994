#pragma once
// Couples light to coding: tolerances from what was coded, through the visibility model.
#include <cstdint>
#include <map>
#include <optional>

#include "app/options/options.h"
#include "core/motion_field.h"
#include "core/picture.h"
#include "core/plane.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "encoder/types.h"
#include "perceptual/visibility_model.h"
#include "scene/model/camera.h"

namespace render2mpeg::app {

struct CouplingSettings {
    perceptual::Strategy strategy = perceptual::Strategy::warped;
    /// Share of masked error; none: by which pictures lose `loss`.
    std::optional<float> fraction;
    double loss = usual_loss;  ///< dB of PSNR-Y by the noise of light, > 0
};

/// Temporal state over one chunk: from coded pictures to the next frames' tolerances. Tolerances come from the newest
/// coded I or P picture, which the plans alone determine.
class Coupling {
  public:
    Coupling(const perceptual::Display& display, const encoder::Settings& coding, const CouplingSettings& settings)
        : model_(display, settings.strategy),
          coding_(coding),
          settings_(settings),
          share_(settings.fraction.value_or(0)) {}

    /// Begins a chunk or a shot.
    void forget();
    /// Replaces a missing previous picture by a rough look at the planned frame.
    /// `light`: as it was lit, by points' first rays; `shown`: as an eye gets it.
    void take_rough_look(const core::Picture& picture, const core::Radiance& light, const core::Radiance& shown,
                         const core::Visible& visible, const encoder::PicturePlan& plan);
    bool remembers() const { return state_.has_value(); }
    /// Takes the newest picture as coded as it was planned, where the coder has not given it back. Only if it
    /// remembers().
    void assume_coded();
    /// Whether tolerances follow quantisers that macroblocks were coded with, not those of a plan.
    bool follows_macroblocks() const { return is_judged_; }

    /// Source of the next frame's tolerances.
    std::int64_t remembered() const { return state_->number; }
    /// `motion` leads to remembered(); null: nothing moves.
    core::ToleranceMap tolerate(const core::Visible& visible, const encoder::PicturePlan& plan,
                                const core::MotionField* motion);

    /// Keeps a picture to be judged; only after tolerate() of the same frame. Learns what I and P pictures lose by
    /// their light: dB, told then.
    std::optional<double> keep(const core::Picture& picture, const core::Radiance& light, const core::Radiance& shown,
                               const core::Visible& visible, const encoder::PicturePlan& plan);
    /// Share of masked error that such a picture may have, if it is the next.
    float share_of(const encoder::PicturePlan& plan) const;
    /// Learns what coding left of a picture. Pictures come in coding order.
    void judge(const encoder::CodedPicture& coded);

    /// Its state between two frames.
    template <class A>
    friend void archive(A& a, Coupling& c) {
        auto& [model, coding, settings, share, of_predicted, state, is_judged, requantised, warped, prediction, kept,
               reference, number] = c;
        a(share, of_predicted, state, is_judged, kept, reference, number);
        if constexpr (std::is_same_v<A, core::ArchiveReader>) requantised.reset();
    }

  private:
    /// A picture until it is coded.
    struct Kept {
        perceptual::Observation seen;
        core::Plane<float> prediction;  ///< along motion (CodedBlocks); empty: none
        perceptual::CodingPlan steps;   ///< planned

        template <class A>
        friend void archive(A& a, Kept& k) {
            auto& [seen, prediction, steps] = k;
            a(seen, prediction, steps);
        }
    };

    perceptual::CodingPlan steps_of(const encoder::PicturePlan& plan, int quantiser) const;
    perceptual::CodedFacts facts_of(const encoder::CodedPicture& coded) const;

    perceptual::VisibilityModel model_;
    encoder::Settings coding_;
    CouplingSettings settings_;
    float share_;                   ///< of I pictures; 0: not known yet
    float share_of_predicted_ = 0;  ///< of P and B pictures, which they tell; 0: as of I pictures
    std::optional<perceptual::TemporalState> state_;
    bool is_judged_ = false;                              ///< of a picture that is coded
    std::optional<perceptual::Requantised> requantised_;  ///< state_, for the frame lit last: B pictures share it
    perceptual::MaskedErrors warped_;                     ///< to the frame being lit
    core::Plane<float> prediction_;                       ///< its luma along motion, if it is to be a P picture
    std::map<std::int64_t, Kept> kept_;
    core::Plane<std::uint8_t> reference_;  ///< luma of the newest I or P picture as coded
    std::int64_t reference_number_ = -1;
};

/// Widens tolerances of a panorama's rows: a viewer sees their pixels as so many fewer, and as much error over their
/// solid angle is hidden as elsewhere.
void widen_poles(const scene::Camera& camera, core::ToleranceMap& tolerance);

}  // namespace render2mpeg::app
