#pragma once
#include "app/options/options.h"

namespace render2mpeg::app {

/// `watch --live`: draws what lines on standard input ask for until they end. Exit status: 0, or 130 after an
/// interruption.
int watch_live(const RenderOptions& options);

}  // namespace render2mpeg::app
