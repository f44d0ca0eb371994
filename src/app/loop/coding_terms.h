#pragma once
#include <cstdint>
#include <optional>

#include "app/loop/coupling.h"
#include "core/plane.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Prediction of a P picture's macroblocks: luma of its decoded `reference` displaced by their vectors [H262, 7.6.4],
/// edges repeated. Intra macroblocks are 0.
core::Plane<std::uint8_t> prediction_of(const encoder::CodedPicture& coded, const core::Plane<std::uint8_t>& reference);

/// A chunk's coding in the terms of the coupling: step sizes and dependencies. Follows coding order.
class CodingTerms {
  public:
    explicit CodingTerms(const encoder::Settings& coding) : coding_(coding) {}

    PlannedPicture planned(const encoder::PicturePlan& plan) const;
    /// None for pictures that no other refers to.
    std::optional<JudgedPicture> coded(const encoder::CodedPicture& coded);

  private:
    perceptual::CodingPlan steps_of(encoder::PictureType type, int quantiser) const;

    encoder::Settings coding_;
    core::Plane<std::uint8_t> reference_;  ///< luma of the newest I or P picture that is coded
};

}  // namespace render2mpeg::app
