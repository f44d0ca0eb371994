#pragma once
// Plots bars over frames as SVG.
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace render2mpeg::app {

/// A frame that a layer says nothing of.
inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Values of one kind, one per frame, or no_value.
struct PlotLayer {
    std::string name;
    std::string style;  ///< CSS class of its colour: "i", "p", "b", "one", "two"
    std::vector<double> values;
};

/// Bars over the frames of a film, layers upon each other; or a mark at each value, where zero says nothing. Frames
/// that share a bar are shown by the mean over them of all layers together, and told by each layer's mean over the
/// frames that it has.
struct FramePlot {
    std::string title;
    std::string unit;
    std::int64_t first = 0;  ///< number of the first frame
    std::vector<PlotLayer> layers;
    bool marks = false;  ///< each frame's value is in one layer at most
};

/// The plot as an SVG element for a page with the styles of report_style(). Films longer than the plot is wide are
/// shown by means over neighbours. Empty for a plot without frames.
std::string svg_of(const FramePlot& plot);

/// The next round number (1, 2 or 5 times a power of ten) that is at least `value`; 1 for 0 and less.
double round_up(double value);

/// Text that may stand in HTML.
std::string escaped(const std::string& text);

}  // namespace render2mpeg::app
