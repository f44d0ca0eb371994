#pragma once
// Couples light to coding: tolerances from what was coded, through the visibility model.
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include "core/motion_field.h"
#include "core/picture.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "encoder/types.h"
#include "perceptual/visibility_model.h"

namespace render2mpeg::app {

/// From which pictures the eye's state is made anew; others only inherit it along motion.
enum class ErrorMaps { references, intra };

/// What the coupled loop is set to.
struct CouplingSettings {
    perceptual::VisibilitySettings visibility;
    ErrorMaps maps = ErrorMaps::references;
    /// Of what coding hides, in pictures that nothing depends on; none: perceptual::default_tolerance_fraction.
    std::optional<float> share;
    bool alike = false;         ///< the same share in all pictures, whatever depends on them: for comparison
    bool always_intra = false;  ///< take every picture for an intra one, as [Render2MPEG] does: for comparison
};

/// The way back of the loop, from what was coded to what the next frames may err by: the eye's state over one chunk.
/// A frame's tolerances come from the newest I or P picture (or I picture, ErrorMaps::intra) that is coded, which is a
/// rule of numbers, not of timing: what has been coded when a frame is lit follows from the plans alone.
class Coupling {
  public:
    /// `tune` decides the encoder's matrices.
    Coupling(const perceptual::Display& display, const CouplingSettings& settings, encoder::Tune tune);

    /// Forgets everything: a chunk begins, or another shot.
    void forget();
    /// Stands in for a picture before the frame that is planned, where there is none: what the frame looks like
    /// roughly.
    void imagine(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
                 const encoder::PicturePlan& plan);
    bool remembers() const { return state_.has_value(); }

    /// The picture that the next frame's tolerances come from.
    std::int64_t remembered() const { return state_->number; }
    /// Tolerances of a frame to be coded by `plan`. `motion` leads to remembered(); null: nothing moves.
    core::ToleranceMap tolerate(const core::Visible& visible, const encoder::PicturePlan& plan,
                                const core::MotionField* motion);

    /// Keeps what may be judged once the picture is coded. Only after tolerate() of the same frame.
    void keep(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
              const encoder::PicturePlan& plan);
    /// Learns how a picture was coded.
    void judge(const encoder::CodedPicture& coded);

  private:
    bool counts(encoder::PictureType type) const;
    float share_for(const encoder::PicturePlan& plan) const;
    perceptual::CodingPlan eye_plan(encoder::PictureType type, int quantiser) const;
    perceptual::CodedFacts facts_of(const encoder::CodedPicture& coded) const;

    perceptual::VisibilityModel model_;
    CouplingSettings settings_;
    perceptual::Quantisation matrices_;
    std::optional<perceptual::TemporalState> state_;
    std::optional<perceptual::Requantised> requantised_;  ///< state_, for the frame lit last: B pictures share it
    perceptual::MaskedErrors warped_;                     ///< to the frame being lit
    std::map<std::int64_t, perceptual::Observation> kept_;
    core::Plane<std::uint8_t> decoded_;  ///< luma of the newest I or P picture that is coded
};

}  // namespace render2mpeg::app
