#pragma once
// Plots curves as SVG.
#include <string>
#include <vector>

namespace render2mpeg::app {

struct CurvePoint {
    double x = 0, y = 0;  ///< left out if not finite, or not positive on a logarithmic axis
    std::string label;    ///< beside the point; may be empty
    bool marked = false;  ///< with a ring
};

/// Points of one kind.
struct Curve {
    std::string name;
    std::string color;  ///< CSS variable of report_style without its dashes: "one", "two", "i"
    std::vector<CurvePoint> points;
    bool joined = true;  ///< in their order; one point is a mark alone
};

struct CurveAxis {
    std::string name;
    bool logarithmic = false;
};

/// Curves over two axes. Each curve has its own kind of mark, too, for eyes that see no colours.
struct CurvePlot {
    std::string title;  ///< says what `y` is
    CurveAxis x, y;
    std::vector<Curve> curves;
};

/// Round values on an axis from `low` to `high` (low < high, 0 < low where it is logarithmic), ascending, two or more,
/// and about `wanted`.
std::vector<double> round_values(double low, double high, bool logarithmic, int wanted);

/// The plot as a figure for a page with the styles of report_style: drawn twice, for a desktop's width and for a
/// phone's, of which the page shows one. Empty for a plot without points.
std::string figure_of(const CurvePlot& plot);

}  // namespace render2mpeg::app
