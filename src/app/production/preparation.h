#pragma once

#include "app/loop/render_job.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// As prepare(), within the memory that the options allow. Not done where an interrupt was requested meanwhile.
RenderJob prepare_within_memory(const RenderOptions& options);

/// Prints what the scene lacks, and which options do nothing.
void print_notes(const RenderJob& film, const RenderOptions& options);

}  // namespace render2mpeg::app
