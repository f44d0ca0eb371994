#pragma once

#include <string>

#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg watch`: a draft of the film, and another one whenever its files change, in a player or a file, until
/// the player is closed or the user interrupts. Returns the exit status. Throws core::Error for what no change of the
/// files would mend.
int watch(const RenderOptions& options, const std::string& command);

}  // namespace render2mpeg::app
