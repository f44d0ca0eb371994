#pragma once

#include <cstdint>
#include <span>

#include "encoder/types.h"

/// Preconditions of the encoder's calls (encoder/encoder.h), checked on entry. All throw core::ContractViolation.
namespace render2mpeg::encoder::mpeg2 {

/// Numbers and lengths of pictures stay below this: over a thousand years of film, and far from overflow anywhere.
inline constexpr std::int64_t most_pictures = std::int64_t{1} << 40;

/// Facts that no picture can have: counts below zero, no numbers, values out of range.
void check_facts(std::int64_t number, const PictureFacts& facts);

/// Refuses impossible results of a first pass: a number twice, no numbers, values out of range.
void check_film(Codec codec, std::span<const FirstPassPicture> film);

/// Sizes of the planes, and what motion and hints lead to. `plan` is as plan() made it.
void check_pushed(const Settings& settings, const core::Picture& picture, const PicturePlan& plan,
                  std::span<const core::MotionField> motion, const Hints& hints);

}  // namespace render2mpeg::encoder::mpeg2
