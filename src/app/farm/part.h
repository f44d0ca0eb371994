#pragma once
// `render2mpeg part`: makes one part of a film that is planned.
#include "app/options/options.h"

namespace render2mpeg::app {

/// Makes the parts that the options name, one after the other. Returns the exit status: 0, or 128 and a signal's number
/// after an interruption. Throws Refusal where they cannot be made here, else core::Error.
int make_parts(const PartOptions& options);

}  // namespace render2mpeg::app
