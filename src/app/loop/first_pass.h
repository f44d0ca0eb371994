#pragma once

#include <vector>

#include "app/loop/render_job.h"
#include "encoder/bit_allocation.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Renders the film once in small and roughly lit, codes it fast, and shares its bits out by what that comes to: one
/// allocation per frame, in order. Empty where it was interrupted. Its time is small against the film's
/// (docs/model/rate-control.md).
std::vector<encoder::BitAllocation> first_pass(const RenderJob& film, bool quiet);

/// The quantiser of MPEG-2 that pictures of about this rate usually need: where a first pass is made.
int usual_quantiser(const encoder::Settings& settings);

}  // namespace render2mpeg::app
