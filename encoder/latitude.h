#pragma once

#include <vector>

#include "core/plane.h"
#include "encoder/types.h"

/// Panoramas: a pixel near a pole takes less of the sphere than one at the equator.
namespace render2mpeg::encoder {

/// What a pixel of each row takes of the sphere, over what one at the equator takes [Sun2017]; empty: pictures are
/// flat.
std::vector<float> weights_of_rows(const Settings& settings);

/// Factor of quantisers and of light's tolerance where a pixel takes `weight` (0..1) of the sphere: one over its root,
/// so that squared errors weighted by solid angle cost as many bits everywhere, at most 4.
float latitude_factor(float weight);

/// Factors of each macroblock's quantiser, (width + 15) / 16 by (height + 15) / 16, by its mean weight. Empty where
/// pictures are flat, or the codec takes one quantiser for a picture.
core::Plane<float> latitude_factors(const Settings& settings);

}  // namespace render2mpeg::encoder
