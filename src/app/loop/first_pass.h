#pragma once

#include <vector>

#include "app/loop/render_job.h"
#include "encoder/bit_allocation.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Renders the film small and rough, codes it fast, and allocates bits by the result, one allocation per frame. Empty
/// after an interruption (docs/model/rate-control.md).
std::vector<encoder::BitAllocation> first_pass(const RenderJob& film, bool quiet);

/// Expected MPEG-2 quantiser of this rate, for a first pass.
int usual_quantiser(const encoder::Settings& settings);

}  // namespace render2mpeg::app
