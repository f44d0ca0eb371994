#pragma once
// Points that share the light of others in their pixel.
#include <cstdint>
#include <vector>

#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Leaves of the requests of an area those that are gathered. A point that is worth fewer rays than a pilot has, by its
/// share of its pixel, is gathered with a chance that is their quotient: a pixel of foliage shows a hundred leaves.
/// Points of a pixel that reflect alike are sorted by where they face and how far they lie, and parted in strata of
/// equal chance, of each of which one is gathered for all [Cochran1977]. Prices alone allow that: bounds are a point's
/// own.
void choose_gathered(FrameState& frame, std::vector<PointRef>& requests);

/// Gives the points of all strata the light that was gathered for one of them, with an error by how it differs from a
/// stratum to the next.
void share_in_pixels(FrameState& frame);

}  // namespace render2mpeg::renderer
