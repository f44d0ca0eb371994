#pragma once
// `render2mpeg farm`: plans a film for many machines.
#include <string>
#include <vector>

#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg farm`. `words` are its command line. Returns the exit status. Throws core::Error.
int farm(const FarmOptions& options, const std::vector<std::string>& words);

}  // namespace render2mpeg::app
