#pragma once
// The table that `cost` prints.
#include <string>

#include "app/experiments/sweep.h"

namespace render2mpeg::app {

/// Lines of at most 80 columns, each with its end.
std::string cost_heading(const RenderJob& film, const Sweep& sweep);
std::string fixed_heading(int quantiser);
std::string fixed_row(const Trial& trial);
std::string pair_heading();
/// Two rows: coupled, and fixed beside it.
std::string pair_rows(const CoupledPair& pair);

}  // namespace render2mpeg::app
