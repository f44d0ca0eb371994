#pragma once
// The table of options.
#include <vector>

#include "app/options/option_row.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// All options, which set the members of `line`.
std::vector<OptionRow> option_rows(CommandLine& line);

}  // namespace render2mpeg::app
