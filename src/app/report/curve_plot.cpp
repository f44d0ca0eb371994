#include "app/report/curve_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/report/figures.h"

namespace render2mpeg::app {
namespace {

/// Target format of a drawing, in its own units, which are pixels at that width.
struct Paper {
    const char* name;
    double width, height;
    int columns, rows;  ///< values on the axes, about
};
constexpr Paper broad{"broad", 860, 380, 8, 6}, narrow{"narrow", 370, 330, 4, 6};
constexpr double left = 66, right_margin = 14, top = 14, bottom_margin = 48, font = 12;

struct Place {
    double x = 0, y = 0;
};

bool shows(const CurvePlot& plot, const CurvePoint& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && (!plot.x.logarithmic || p.x > 0) &&
           (!plot.y.logarithmic || p.y > 0);
}

/// One axis: values on it, and where they lie between 0 and 1.
struct Scale {
    double low = 0, high = 1;
    bool logarithmic = false;

    double share(double value) const {
        return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    }
};

/// Spans all points with room for their marks and labels.
Scale scale_of(const CurvePlot& plot, bool horizontal) {
    const CurveAxis& axis = horizontal ? plot.x : plot.y;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Curve& curve : plot.curves)
        for (const CurvePoint& p : curve.points) {
            if (!shows(plot, p)) continue;
            low = std::min(low, horizontal ? p.x : p.y);
            high = std::max(high, horizontal ? p.x : p.y);
        }
    constexpr double room = 0.07;
    if (axis.logarithmic) {
        const double factor = std::max(std::pow(high / low, room), 1.1);
        return {low / factor, high * factor, true};
    }
    // An invisible difference must not look like a cliff: a decibel axis spans at least three. chosen: six times half a
    // decibel.
    if (axis.name.find("dB") != std::string::npos && high - low < 3) {
        const double middle = (low + high) / 2;
        low = middle - 1.5;
        high = middle + 1.5;
    }
    // Equal values get an axis of some extent too.
    const double extent = std::max((high - low) * room, 1e-3 * std::max(std::abs(high), 1.0));
    return {low - extent, high + extent, false};
}

std::string figure(double value) {
    return std::abs(value) >= 1e4 ? count_text(value) : fmt::format("{:.4g}", value);
}

/// chosen: letters of this font are some 0.56 of its size wide.
double width_of(const std::string& text) {
    return 0.56 * font * static_cast<double>(text.size());
}

/// The next round number (1, 2 or 5 times a power of ten) that is at least `value` > 0.
double round_up(double value) {
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= value * (1 - 1e-9)) return step * power;
    return 10 * power;
}

std::vector<double> even_values(double low, double high, int wanted) {
    const double step = round_up((high - low) / (wanted + 1));
    std::vector<double> values;
    for (double k = std::ceil(low / step); k * step <= high * (1 + 1e-12) && values.size() < 100; ++k)
        values.push_back(k * step + 0.0);  // not "-0"
    return values;
}

/// Those of `digits` times a power of ten, of every so many powers.
std::vector<double> decade_values(double low, double high, const std::vector<double>& digits, int every) {
    std::vector<double> values;
    const int first = static_cast<int>(std::floor(std::log10(low)));
    for (int power = first - (first % every + every) % every; std::pow(10.0, power) <= high; power += every)
        for (const double digit : digits)
            if (const double value = digit * std::pow(10.0, power); value >= low && value <= high)
                values.push_back(value);
    return values;
}

class Drawing {
  public:
    Drawing(const CurvePlot& plot, const Paper& paper)
        : plot_(plot),
          paper_(paper),
          x_(scale_of(plot, true)),
          y_(scale_of(plot, false)),
          right_(paper.width - right_margin),
          bottom_(paper.height - bottom_margin) {}

    std::string text();

  private:
    Place place(const CurvePoint& p) const {
        return {left + (right_ - left) * x_.share(p.x), bottom_ - (bottom_ - top) * y_.share(p.y)};
    }
    std::string axes() const;
    std::string line(const Curve& curve) const;
    std::string mark(std::size_t kind, Place at, double size) const;
    std::string marks(const Curve& curve, std::size_t kind) const;
    std::string label(const CurvePoint& point) const;

    const CurvePlot& plot_;
    const Paper& paper_;
    Scale x_, y_;
    double right_, bottom_;
};

std::string Drawing::axes() const {
    std::string text;
    for (const double value : round_values(y_.low, y_.high, y_.logarithmic, paper_.rows)) {
        const double y = bottom_ - (bottom_ - top) * y_.share(value);
        text += fmt::format(R"(<line class="grid" x1="{}" x2="{}" y1="{:.1f}" y2="{:.1f}"/>)", left, right_, y, y);
        text += fmt::format(R"(<text x="{}" y="{:.1f}" text-anchor="end">{}</text>)", left - 6, y + 4, figure(value));
    }
    for (const double value : round_values(x_.low, x_.high, x_.logarithmic, paper_.columns)) {
        const double x = left + (right_ - left) * x_.share(value);
        text += fmt::format(R"(<line class="grid" x1="{:.1f}" x2="{:.1f}" y1="{}" y2="{}"/>)", x, x, top, bottom_);
        text +=
            fmt::format(R"(<text x="{:.1f}" y="{}" text-anchor="middle">{}</text>)", x, bottom_ + 17, figure(value));
    }
    text += fmt::format(R"~(<text transform="translate(12 {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)~",
                        (top + bottom_) / 2, escaped(plot_.y.name));
    return text + fmt::format(R"(<text x="{:.1f}" y="{}" text-anchor="middle">{}</text>)", (left + right_) / 2,
                              paper_.height - 8, escaped(plot_.x.name));
}

std::string Drawing::line(const Curve& curve) const {
    std::string path;
    for (const CurvePoint& p : curve.points) {
        if (!curve.joined || !shows(plot_, p)) continue;
        const Place at = place(p);
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", at.x, at.y);
    }
    return path.empty() ? "" : fmt::format(R"(<path class="line" d="{}"/>)", path);
}

/// Round, square, on its tip, triangle.
std::string Drawing::mark(std::size_t kind, Place at, double size) const {
    const auto [x, y] = at;
    switch (kind % 4) {
        case 0:
            return fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}"/>)", x, y, size);
        case 1:
            return fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/>)", x - size, y - size,
                               2 * size, 2 * size);
        case 2:
            return fmt::format(R"(<path d="M{:.1f} {:.1f}l{} {}l-{} {}l-{} -{}z"/>)", x, y - 1.4 * size, 1.4 * size,
                               1.4 * size, 1.4 * size, 1.4 * size, 1.4 * size, 1.4 * size);
        default:
            return fmt::format(R"(<path d="M{:.1f} {:.1f}l{} {}h-{}z"/>)", x, y - 1.3 * size, 1.3 * size, 2.4 * size,
                               2.6 * size);
    }
}

std::string Drawing::marks(const Curve& curve, std::size_t kind) const {
    std::string text;
    for (const CurvePoint& p : curve.points) {
        if (!shows(plot_, p)) continue;
        const Place at = place(p);
        text += "<g>" + mark(kind, at, curve.points.size() > 100 ? 2 : 4);
        if (p.marked) text += fmt::format(R"(<circle class="ring" cx="{:.1f}" cy="{:.1f}" r="9"/>)", at.x, at.y);
        text += fmt::format("<title>{}{}{}: {} {}, {} {}</title></g>", escaped(curve.name), p.label.empty() ? "" : ", ",
                            escaped(p.label), escaped(plot_.x.name), figure(p.x), escaped(plot_.y.name), figure(p.y));
    }
    return text;
}

/// Above the point and behind it, or before it where there is no room.
std::string Drawing::label(const CurvePoint& point) const {
    if (point.label.empty() || !shows(plot_, point)) return {};
    const Place at = place(point);
    const double gap = point.marked ? 12 : 7;
    const bool fits = at.x + gap + width_of(point.label) <= right_;
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}"{}>{}</text>)", fits ? at.x + gap : at.x - gap, at.y - gap,
                       fits ? "" : R"( text-anchor="end")", escaped(point.label));
}

std::string Drawing::text() {
    std::string drawn = fmt::format(R"(<svg class="{}" viewBox="0 0 {} {}" role="img" aria-label="{}">)", paper_.name,
                                    paper_.width, paper_.height, escaped(plot_.title)) +
                        axes();
    for (std::size_t i = 0; i < plot_.curves.size(); ++i)
        drawn += fmt::format(R"~(<g style="color:var(--{})">)~", plot_.curves[i].color) + line(plot_.curves[i]) +
                 marks(plot_.curves[i], i) + "</g>";
    for (const Curve& curve : plot_.curves)
        for (const CurvePoint& p : curve.points) drawn += label(p);
    return drawn + "</svg>";
}

/// The curve's own mark and colour before its name.
std::string key(const Curve& curve, std::size_t kind) {
    constexpr const char* signs[] = {"&#9679;", "&#9632;", "&#9670;", "&#9650;"};
    return fmt::format(R"~(<span class="key"><span style="color:var(--{})">{}</span> {}</span>)~", curve.color,
                       signs[kind % 4], escaped(curve.name));
}

}  // namespace

std::vector<double> round_values(double low, double high, bool logarithmic, int wanted) {
    if (!logarithmic) return even_values(low, high, wanted);
    // The finest digits that give no more values than wanted; where all of them are too many, fewer powers of ten.
    const auto most = static_cast<std::size_t>(wanted);
    std::vector<double> values = decade_values(low, high, {1}, 1);
    for (const std::vector<double>& digits : {std::vector<double>{1, 3}, {1, 2, 5}, {1, 2, 3, 4, 5, 6, 7, 8, 9}})
        if (std::vector<double> more = decade_values(low, high, digits, 1); more.size() <= most) values = more;
    for (int every = 2; values.size() > most; ++every) values = decade_values(low, high, {1}, every);
    return values.size() >= 2 ? values : even_values(low, high, wanted);
}

std::string figure_of(const CurvePlot& plot) {
    const auto any = [&](const Curve& curve) {
        return std::any_of(curve.points.begin(), curve.points.end(),
                           [&](const CurvePoint& p) { return shows(plot, p); });
    };
    if (std::none_of(plot.curves.begin(), plot.curves.end(), any)) return {};
    std::string legend;
    for (std::size_t i = 0; i < plot.curves.size(); ++i)
        if (any(plot.curves[i])) legend += key(plot.curves[i], i);
    return fmt::format(
        "<figure class=\"curves\"><figcaption><h3>{}</h3><span>{}</span></figcaption>"
        "{}{}</figure>\n",
        escaped(plot.title), legend, Drawing(plot, broad).text(), Drawing(plot, narrow).text());
}

}  // namespace render2mpeg::app
