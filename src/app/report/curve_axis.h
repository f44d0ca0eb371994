#pragma once
// The axes of plots of curves.
#include <vector>

namespace render2mpeg::app {

/// Values on an axis from `low` to `high` (low < high, 0 < low where it is logarithmic) that are round, ascending, two
/// or more, and about `wanted`.
std::vector<double> round_values(double low, double high, bool logarithmic, int wanted);

/// The next round number (1, 2 or 5 times a power of ten) that is at least `value`; 1 for 0 and less.
double round_up(double value);

}  // namespace render2mpeg::app
