#pragma once
// Couples light to coding: tolerances from what was coded, through the visibility model.
#include <cstdint>
#include <map>
#include <optional>

#include "core/motion_field.h"
#include "core/picture.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "perceptual/visibility_model.h"

namespace render2mpeg::app {

/// What the coupled loop is set to.
struct CouplingSettings {
    perceptual::Strategy strategy = perceptual::Strategy::warped;
    /// Of what coding masks, in pictures that nothing depends on; none: perceptual::default_tolerance_fraction.
    std::optional<float> fraction;
};

/// What other pictures make of a picture.
enum class PictureRole {
    intra,       ///< others may refer to it; it refers to none
    predicted,   ///< others may refer to it
    disposable,  ///< none does
};

/// How a picture is going to be coded: all that the coupling knows of a codec before it codes.
struct PlannedPicture {
    std::int64_t number = 0;
    PictureRole role = PictureRole::intra;
    std::int64_t followers = 0;  ///< pictures that depend on it, directly or not
    perceptual::CodingPlan steps;
    float hidden = 1;  ///< factor of the share of errors as large as these steps that light may use, > 0
};

/// How it was coded.
struct JudgedPicture {
    PictureRole role = PictureRole::intra;
    perceptual::CodedFacts facts;
};

/// The way back of the loop, from what was coded to what the next frames may err by: the temporal state over one
/// chunk. A frame's tolerances come from the newest I or P picture that is coded,
/// which is a rule of numbers, not of timing: what has been coded when a frame is lit follows from the plans alone.
/// Knows a codec only by PlannedPicture and JudgedPicture (coding_terms.h).
class Coupling {
  public:
    Coupling(const perceptual::Display& display, const CouplingSettings& settings)
        : model_(display, settings.strategy), settings_(settings) {}

    /// Forgets everything: a chunk begins, or another shot.
    void forget();
    /// Stands in for a picture before the frame that is planned, where there is none: what the frame looks like
    /// roughly.
    void imagine(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
                 const PlannedPicture& plan);
    bool remembers() const { return state_.has_value(); }

    /// The picture that the next frame's tolerances come from.
    std::int64_t remembered() const { return state_->number; }
    /// Tolerances of a frame to be coded by `plan`. `motion` leads to remembered(); null: nothing moves.
    core::ToleranceMap tolerate(const core::Visible& visible, const PlannedPicture& plan,
                                const core::MotionField* motion);

    /// Keeps what may be judged once the picture is coded. Only after tolerate() of the same frame.
    void keep(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
              const PlannedPicture& plan);
    /// Learns how a picture was coded.
    void judge(const JudgedPicture& picture);

  private:
    float fraction_for(const PlannedPicture& plan) const;

    perceptual::VisibilityModel model_;
    CouplingSettings settings_;
    std::optional<perceptual::TemporalState> state_;
    std::optional<perceptual::Requantised> requantised_;  ///< state_, for the frame lit last: B pictures share it
    perceptual::MaskedErrors warped_;                     ///< to the frame being lit
    std::map<std::int64_t, perceptual::Observation> kept_;
};

}  // namespace render2mpeg::app
