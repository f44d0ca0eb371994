#pragma once
// The visibility model's loop: masks a picture, judges its coding, and tolerates errors in the next.
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "core/archive.h"
#include "core/motion_field.h"
#include "core/picture.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "core/visible.h"
#include "perceptual/display.h"
#include "perceptual/distortion.h"
#include "perceptual/inverse_luma.h"
#include "perceptual/masking.h"
#include "perceptual/tolerance.h"
#include "perceptual/warp.h"

/// The visibility model: errors masked by one picture become the tolerance of the next frame, warped along motion.
namespace render2mpeg::perceptual {

/// The two ways of [Render2MPEG, 4.3] to use the masking of one picture for the next.
enum class Strategy : std::uint8_t {
    warped,     ///< masking by the picture as rendered, warped along motion
    quantised,  ///< masking by the picture as decoded, its coding errors included, place by place: for slow films
};

/// How a picture is going to be coded.
struct CodingPlan {
    bool intra = true;    ///< picture type I; others are predicted
    float scale = 0.25f;  ///< nominal qs (BlockCoding::scale), > 0
    Quantisation quantisation;

    bool operator==(const CodingPlan& other) const;
};

/// How it was coded, macroblock by macroblock: (width + 15) / 16 by (height + 15) / 16 of them.
struct CodedFacts {
    std::int64_t number = 0;  ///< display number
    CodingPlan plan;
    std::optional<CodingPlan> lit_for;         ///< the plan that tolerate() was told of; none: the same
    core::Plane<std::uint8_t> intra;           ///< 1: intra macroblock
    core::Plane<float> scale;                  ///< qs in force, > 0
    core::Plane<std::uint8_t> reconstruction;  ///< luma, decoded; may be empty unless Strategy::quantised
    core::Plane<std::uint8_t> prediction;      ///< luma that inter macroblocks add to; may be empty: not known
};

/// Permissible errors of pixels (dY), and the pixel luminance each holds for.
using MaskedErrors = core::Plane<glm::vec2>;

/// A picture before coding, with the data that later pictures need.
struct Observation {
    std::int64_t number = 0;
    std::shared_ptr<const core::Visible> visible;
    core::Plane<core::Block8x8> coefficients;  ///< DCT of its luma
    ThresholdMap thresholds;                   ///< eq. 7.1 and 7.2: the encoder's input from the eye
    PixelLight light;
    core::Plane<float> warped;  ///< dY(t - 1) at its pixels, for the light they got; empty: none
};

/// Analysis of one coded picture. Immutable; keeps the inputs of eq. 7.1-7.2, so that another quantiser or picture type
/// changes the very next tolerances.
struct TemporalState {
    std::int64_t number = 0;
    std::shared_ptr<const core::Visible> visible;
    core::Plane<core::Block8x8> coefficients;  ///< of the masking signal: the picture, or its decoded version
    core::Plane<core::Block8x8> residual;      ///< of the picture minus its prediction; empty: not known
    ThresholdMap thresholds;
    PixelLight light;
    core::Plane<std::uint8_t> intra;  ///< by macroblock
    /// By macroblock: the scale in force over the plan's. What an encoder found worth coding finer or coarser there is
    /// expected of the next pictures, too.
    core::Plane<float> emphasis;
    CodingPlan plan;                ///< it was coded by
    core::Plane<float> errors;      ///< e_xy (7.4), by the quantisers really used; luminance, > 0
    core::Plane<float> tolerances;  ///< dY_xy(t) (7.5), likewise
};

/// Every member of what is kept between pictures.
template <class A>
void archive(A& a, Observation& o) {
    auto& [number, visible, coefficients, thresholds, light, warped] = o;
    a(number, visible, coefficients, thresholds, light, warped);
}
template <class A>
void archive(A& a, TemporalState& s) {
    auto& [number, visible, coefficients, residual, thresholds, light, intra, emphasis, plan, errors, tolerances] = s;
    a(number, visible, coefficients, residual, thresholds, light, intra, emphasis, plan, errors, tolerances);
}

/// Errors of a future picture masked by a remembered one: the same for all pictures with the same coding plan.
struct Requantised {
    CodingPlan plan;
    MaskedErrors masked;     ///< at the state's pixels, > 0
    float low_fraction = 0;  ///< of its luminance, that a quarter of the pixels stay below; 0..0.5, 0: unknown
};

/// A frame's tolerances before it is lit.
struct Tolerated {
    core::ToleranceMap map;
    MaskedErrors warped;  ///< for its Observation: dY(t - 1) for its plan, `no_partner` (warp.h) where none
};

/// The eye of the loop (docs/model/tolerance.md): masking by the picture before becomes the tolerance of this frame.
/// Immutable; state is passed in and out.
class VisibilityModel {
  public:
    VisibilityModel(const Display& display, Strategy strategy = Strategy::warped);

    /// Masking [Render2MPEG, eq. 7.1, 7.2] and what else is to be kept of a frame. `picture` was developed from
    /// `radiance` and has its unrounded luma. `warped`: as tolerate() said.
    Observation observe(const core::Picture& picture, const core::Radiance& radiance,
                        std::shared_ptr<const core::Visible> visible, const MaskedErrors& warped = {}) const;

    /// Errors [7.3, 7.4] of a picture that was coded, with the quantisers really used, blended with those warped to it
    /// [7.5]. `coded` is of the same picture.
    TemporalState judge(Observation observation, const CodedFacts& coded) const;

    /// The same for a picture that was only seen coarsely and will not be coded as it is, as if coded by `plan`.
    TemporalState assume_coded(Observation observation, const CodingPlan& plan) const;

    /// Tolerances of a frame that is going to be coded by `plan`: what `state` hides, times `fraction`, warped along
    /// `motion` (from the frame to the state's picture; null: nothing moves), never below 2 % of the pixel's luminance
    /// nor below half a code value. Pixels without a match take the lower quartile of the state's relative tolerances,
    /// weighted by luma; near-black pixels, which may lose half their light, do not count. fraction > 0.
    Tolerated tolerate(const core::Visible& visible, const CodingPlan& plan, const TemporalState& state,
                       const core::MotionField* motion, float fraction) const;

    /// The two halves of it, for who lights several frames from one state.
    Requantised requantise(const TemporalState& state, const CodingPlan& plan) const;
    Tolerated tolerate(const core::Visible& visible, const Requantised& requantised, const TemporalState& state,
                       const core::MotionField* motion, float fraction) const;

    /// e_xy of the remembered picture if it were coded by `plan`.
    core::Plane<float> errors(const TemporalState& state, const CodingPlan& plan) const;

    const InverseLuma& light() const { return light_; }

  private:
    /// Tolerances at the state's pixels, told for coding by `from`, as they would be for coding by `to`.
    void requantise(core::Plane<float>& values, const TemporalState& state, const CodingPlan& from,
                    const CodingPlan& to) const;

    InverseLuma light_;
    Strategy strategy_;
};

}  // namespace render2mpeg::perceptual
