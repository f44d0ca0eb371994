#pragma once

#include <string>
#include <vector>

#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg cost`: lights and codes a sample of a film with one tolerance after the other (docs/choosing.md).
/// Returns the exit status: 0, or 130 after an interruption, with what was finished until then. Throws core::Error.
int cost(const CostOptions& options, const std::vector<std::string>& words);

}  // namespace render2mpeg::app
