#pragma once
// The axes of plots of curves.
#include <vector>

namespace render2mpeg::app {

/// Values on an axis from `low` to `high` (low < high, 0 < low where it is logarithmic) that are round, ascending, two
/// or more, and about `wanted`.
std::vector<double> round_values(double low, double high, bool logarithmic, int wanted);

}  // namespace render2mpeg::app
