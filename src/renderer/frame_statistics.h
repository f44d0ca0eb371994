#pragma once
// Adds what a frame's passes counted to the statistics.
#include "core/visible.h"
#include "renderer/caustics/caustics.h"
#include "renderer/cut/shade.h"
#include "renderer/renderer.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

void add(const ShadeCounts& counts, const core::Visible& visible, Statistics& statistics);
void add(const CausticCounts& counts, Statistics& statistics);
void add(const SeeCounts& counts, Statistics& statistics);
/// Of one more frame.
void add_error_scale(double value, Statistics& statistics);

}  // namespace render2mpeg::renderer
