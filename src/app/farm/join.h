#pragma once
// `render2mpeg join`: puts the parts of a film together.
#include "app/options/options.h"

namespace render2mpeg::app {

/// Returns the exit status. Throws core::Error, naming the parts that are not whole.
int join(const JoinOptions& options);

}  // namespace render2mpeg::app
