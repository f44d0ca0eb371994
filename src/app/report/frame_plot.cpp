#include "app/report/frame_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/report/figures.h"
#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

/// Places in the SVG's own units, which are pixels of a page 860 wide.
constexpr double bars_left = 58, bars_right = 850, bars_top = 10, bars_bottom = 150, bars_height = 192;
/// chosen: bars thinner than a pixel are no bars.
constexpr std::size_t most_bars = 720;

/// A figure on an axis or in a hint.
std::string bar_figure(double value) {
    return value >= 1e4 ? count_text(value) : fmt::format("{:.4g}", value);
}

/// Values of a layer under one bar.
struct Part {
    double sum = 0;
    std::size_t count = 0;
    double mean() const { return core::divide_or(sum, static_cast<double>(count), 0.0); }
};

/// Frames that share a bar.
struct Bars {
    std::size_t frames = 0, per_bar = 1;
    std::size_t count() const { return (frames + per_bar - 1) / per_bar; }
    std::size_t frames_of(std::size_t bar) const { return std::min(frames, (bar + 1) * per_bar) - bar * per_bar; }
    Part part(const PlotLayer& layer, std::size_t bar) const {
        Part part;
        for (std::size_t i = bar * per_bar; i < bar * per_bar + frames_of(bar); ++i)
            if (std::isfinite(layer.values[i])) part = {part.sum + layer.values[i], part.count + 1};
        return part;
    }
    /// What a layer adds to the mean over all frames of a bar.
    double share(const PlotLayer& layer, std::size_t bar) const {
        return core::divide_or(part(layer, bar).sum, static_cast<double>(frames_of(bar)), 0.0);
    }
};

Bars bars_of(const FramePlot& plot) {
    Bars bars;
    bars.frames = plot.layers.empty() ? 0 : plot.layers.front().values.size();
    bars.per_bar = std::max<std::size_t>(1, (bars.frames + most_bars - 1) / most_bars);
    return bars;
}

/// What a bar comes to: the mean over its frames of all layers together. Of marks, over the frames that have one.
Part total(const FramePlot& plot, const Bars& bars, std::size_t bar) {
    Part all;
    for (const PlotLayer& layer : plot.layers) {
        const Part part = bars.part(layer, bar);
        all = {all.sum + part.sum, all.count + part.count};
    }
    return plot.marks ? all : Part{all.sum, bars.frames_of(bar)};
}

/// The values that the vertical axis spans, in four steps.
struct BarScale {
    double low = 0, step = 1;
    double y(double value) const { return bars_bottom - (bars_bottom - bars_top) * (value - low) / (4 * step); }
};

BarScale scale_of(const FramePlot& plot, const Bars& bars) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (std::size_t bar = 0; bar < bars.count(); ++bar) {
        const Part all = total(plot, bars, bar);
        if (all.count == 0) continue;
        most = std::max(most, all.mean());
        least = std::min(least, all.mean());
    }
    least = std::min(least, most);
    if (!plot.marks) return {0, round_up(most) / 4};
    BarScale scale{0, round_up(std::max(1e-3 * most, (most - least) / 4))};
    scale.low = scale.step * std::floor(least / scale.step);
    if (scale.low + 4 * scale.step >= most) return scale;
    scale.step = round_up(1.5 * scale.step);
    scale.low = scale.step * std::floor(least / scale.step);
    return scale;
}

std::string axes(const FramePlot& plot, const Bars& bars, const BarScale& scale) {
    std::string text;
    for (int i = 0; i <= 4; ++i) {
        const double y = bars_bottom - (bars_bottom - bars_top) * i / 4;
        text +=
            fmt::format(R"(<line class="grid" x1="{}" x2="{}" y1="{:.1f}" y2="{:.1f}"/>)", bars_left, bars_right, y, y);
        text += fmt::format(R"(<text x="{}" y="{:.1f}" text-anchor="end">{}</text>)", bars_left - 6, y + 4,
                            bar_figure(scale.low + scale.step * i));
    }
    const double step = std::max(1.0, round_up(static_cast<double>(bars.frames) / 10));
    for (double frame = 0; frame < static_cast<double>(bars.frames); frame += step)
        text += fmt::format(R"(<text x="{:.1f}" y="{}" text-anchor="middle">{:.0f}</text>)",
                            bars_left + (bars_right - bars_left) * (frame + 0.5) / static_cast<double>(bars.frames),
                            bars_bottom + 18, static_cast<double>(plot.first) + frame);
    text += fmt::format(R"(<text x="{:.1f}" y="{}" text-anchor="middle">frame</text>)", (bars_left + bars_right) / 2,
                        bars_bottom + 36);
    return text + fmt::format(R"~(<text transform="translate(12 {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)~",
                              (bars_top + bars_bottom) / 2, escaped(plot.unit));
}

/// What a pointer over a bar shows.
std::string hint(const FramePlot& plot, const Bars& bars, std::size_t bar) {
    const std::int64_t from = plot.first + static_cast<std::int64_t>(bar * bars.per_bar);
    const std::int64_t to =
        std::min(plot.first + static_cast<std::int64_t>(bars.frames), from + static_cast<std::int64_t>(bars.per_bar)) -
        1;
    std::string text = from == to ? fmt::format("frame {}", from) : fmt::format("frames {} to {}, mean", from, to);
    const std::string unit = plot.unit.empty() ? "" : " " + plot.unit;
    for (const PlotLayer& layer : plot.layers)
        if (const Part part = bars.part(layer, bar); part.count > 0)
            text += fmt::format(", {} {}{}", layer.name, bar_figure(part.mean()), unit);
    return escaped(text);
}

std::string rectangle(const std::string& style, double x, double y, double width, double tall) {
    return fmt::format(R"(<rect class="{}" x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}"/>)", style, x, y, width,
                       tall);
}

/// A mark at what a bar comes to, in the colour of the layer that most of its frames have.
std::string mark(const FramePlot& plot, const Bars& bars, std::size_t bar, const BarScale& scale, double x,
                 double width) {
    const Part all = total(plot, bars, bar);
    if (all.count == 0) return {};
    const auto most = std::max_element(
        plot.layers.begin(), plot.layers.end(),
        [&](const PlotLayer& a, const PlotLayer& b) { return bars.part(a, bar).count < bars.part(b, bar).count; });
    return rectangle(most->style, x, scale.y(all.mean()) - 1.5, width, 3);
}

std::string stack(const FramePlot& plot, const Bars& bars, std::size_t bar, const BarScale& scale, double x,
                  double width) {
    std::string text;
    double sum = 0;
    for (const PlotLayer& layer : plot.layers) {
        const double value = bars.share(layer, bar);
        if (!(value > 0)) continue;
        sum += value;
        text += rectangle(layer.style, x, scale.y(sum), width, scale.y(sum - value) - scale.y(sum));
    }
    return text;
}

std::string columns(const FramePlot& plot, const Bars& bars, const BarScale& scale) {
    const double pitch =
        (bars_right - bars_left) * static_cast<double>(bars.per_bar) / static_cast<double>(bars.frames);
    std::string text;
    for (std::size_t bar = 0; bar < bars.count(); ++bar) {
        const double x = bars_left + pitch * static_cast<double>(bar);
        const double width =
            std::min(bars_right - x, pitch > 4 ? pitch - 1 : pitch);  // the last may stand for fewer frames
        text += "<g>" +
                (plot.marks ? mark(plot, bars, bar, scale, x, width) : stack(plot, bars, bar, scale, x, width)) +
                "<title>" + hint(plot, bars, bar) + "</title></g>";
    }
    return text;
}

std::string legend(const FramePlot& plot) {
    if (plot.layers.size() < 2) return {};
    std::string text;
    for (const PlotLayer& layer : plot.layers)
        text += fmt::format(R"(<span class="key"><span class="swatch {}"></span>{}</span>)", layer.style,
                            escaped(layer.name));
    return text;
}

}  // namespace

double round_up(double value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= value * (1 - 1e-9)) return step * power;
    return 10 * power;
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                // Control characters have no place in HTML; names of files may hold them.
                result += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
        }
    }
    return result;
}

std::string svg_of(const FramePlot& plot) {
    const Bars bars = bars_of(plot);
    if (bars.frames == 0) return {};
    const BarScale scale = scale_of(plot, bars);
    const std::string unit = plot.unit.empty() ? "" : " <small>" + escaped(plot.unit) + "</small>";
    return fmt::format(
        R"(<figure><figcaption><h3>{}{}</h3><span>{}</span></figcaption><div class="wide"><svg viewBox="0 0 860 {}" role="img" aria-label="{}">{}{}</svg></div></figure>)"
        "\n",
        escaped(plot.title), unit, legend(plot), bars_height, escaped(plot.title), axes(plot, bars, scale),
        columns(plot, bars, scale));
}

}  // namespace render2mpeg::app
