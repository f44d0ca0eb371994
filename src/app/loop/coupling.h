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

struct CouplingSettings {
    perceptual::Strategy strategy = perceptual::Strategy::warped;
    /// Share of masked error in pictures that nothing depends on; none: perceptual::default_tolerance_fraction.
    std::optional<float> fraction;
};

enum class PictureRole {
    intra,       ///< others may refer to it; it refers to none
    predicted,   ///< others may refer to it
    disposable,  ///< none does
};

/// Plan of a picture: all that the coupling knows of a codec before it codes.
struct PlannedPicture {
    std::int64_t number = 0;
    PictureRole role = PictureRole::intra;
    std::int64_t followers = 0;  ///< pictures that depend on it, directly or not
    perceptual::CodingPlan steps;
    float hidden = 1;  ///< factor of the share of errors as large as these steps that light may use, > 0
};

struct JudgedPicture {
    PictureRole role = PictureRole::intra;
    perceptual::CodedFacts facts;
};

/// Temporal state over one chunk: from coded pictures to the next frames' tolerances. Tolerances come from the newest
/// coded I or P picture, which the plans alone determine. Knows codecs only by PlannedPicture and JudgedPicture
/// (coding_terms.h).
class Coupling {
  public:
    Coupling(const perceptual::Display& display, const CouplingSettings& settings)
        : model_(display, settings.strategy), settings_(settings) {}

    /// Begins a chunk or a shot.
    void forget();
    /// Replaces a missing previous picture by a rough look at the planned frame.
    void take_rough_look(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
                         const PlannedPicture& plan);
    bool remembers() const { return state_.has_value(); }

    /// Source of the next frame's tolerances.
    std::int64_t remembered() const { return state_->number; }
    /// `motion` leads to remembered(); null: nothing moves.
    core::ToleranceMap tolerate(const core::Visible& visible, const PlannedPicture& plan,
                                const core::MotionField* motion);

    /// Keeps a picture to be judged; only after tolerate() of the same frame.
    void keep(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
              const PlannedPicture& plan);
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
