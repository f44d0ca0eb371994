#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>

#include "encoder_rd/report.h"

namespace render2mpeg::bench {
namespace {

constexpr double panel_width = 430, panel_height = 360, left = 58, top = 44, gap = 70;

/// One measure's curves in their frame. Rates are logarithmic, in Mbit/s at 30 pictures per second.
class Panel {
  public:
    Panel(const char* title, double x0) : title_(title), x0_(x0) {}

    void add(const Curve& curve, double (*quality)(const Measured&)) {
        auto& points = curves_[curve.codec];
        for (const Measured& m : curve.points) {
            points.push_back({m.bits / static_cast<double>(m.pictures) * 30e-6, quality(m)});
            x_low_ = std::min(x_low_, points.back()[0]);
            x_high_ = std::max(x_high_, points.back()[0]);
            y_low_ = std::min(y_low_, points.back()[1]);
            y_high_ = std::max(y_high_, points.back()[1]);
        }
        std::sort(points.begin(), points.end());
    }

    std::string svg(const std::map<std::string, const char*>& colours) const {
        std::string s = fmt::format("<rect x='{}' y='{}' width='{}' height='{}' fill='#fff' stroke='#888'/>", x0_, top,
                                    panel_width, panel_height);
        s += fmt::format("<text x='{}' y='{}' font-weight='bold'>{}, dB</text>", x0_, top - 10, title_);
        s += grid();
        for (const auto& [codec, points] : curves_) {
            s += fmt::format("<polyline fill='none' stroke-width='1.6' stroke='{}' points='", colours.at(codec));
            for (const auto& p : points) s += fmt::format("{:.1f},{:.1f} ", x(p[0]), y(p[1]));
            s += "'/>";
            for (const auto& p : points)
                s += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2.6' fill='{}'/>", x(p[0]), y(p[1]),
                                 colours.at(codec));
        }
        return s;
    }

  private:
    double x(double rate) const {
        const double low = std::log(x_low_ / 1.1), high = std::log(x_high_ * 1.1);
        return x0_ + panel_width * (std::log(rate) - low) / std::max(1e-9, high - low);
    }
    double y(double quality) const {
        return top + panel_height * (1 - (quality - y_low_ + 0.5) / std::max(1e-9, y_high_ - y_low_ + 1));
    }

    std::string grid() const {
        std::string s;
        const auto label = [](double at_x, double at_y, const char* anchor, const std::string& text) {
            return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}' fill='#555'>{}</text>", at_x, at_y, anchor,
                               text);
        };
        for (double decade = 0.001; decade < 1e4; decade *= 10)
            for (const double step : {1.0, 2.0, 5.0}) {
                const double rate = decade * step;
                if (rate < x_low_ / 1.1 || rate > x_high_ * 1.1) continue;
                s += fmt::format("<path d='M{:.1f} {}v{}' stroke='#ddd'/>", x(rate), top, panel_height);
                s += label(x(rate), top + panel_height + 15, "middle", fmt::format("{:g}", rate));
            }
        for (double level = std::ceil((y_low_ - 0.5) / 2) * 2; level <= y_high_ + 0.5; level += 2) {
            s += fmt::format("<path d='M{} {:.1f}h{}' stroke='#ddd'/>", x0_, y(level), panel_width);
            s += label(x0_ - 6, y(level) + 4, "end", fmt::format("{:g}", level));
        }
        return s + label(x0_ + panel_width, top + panel_height + 32, "end", "Mbit/s at 30 Hz");
    }

    const char* title_;
    double x0_;
    std::map<std::string, std::vector<std::array<double, 2>>> curves_;
    double x_low_ = std::numeric_limits<double>::infinity(), x_high_ = 0;
    double y_low_ = std::numeric_limits<double>::infinity(), y_high_ = -y_low_;
};

}  // namespace

void write_plots(const std::filesystem::path& folder, const std::vector<Curve>& curves) {
    constexpr std::array<const char*, 8> palette = {"#c0392b", "#2471a3", "#1e8449", "#b7950b",
                                                    "#7d3c98", "#17a589", "#34495e", "#d35400"};
    std::map<std::string, std::vector<const Curve*>> by_clip;
    std::map<std::string, const char*> colours;
    for (const Curve& curve : curves) {
        by_clip[curve.clip].push_back(&curve);
        colours.try_emplace(curve.codec, palette[colours.size() % palette.size()]);
    }
    std::filesystem::create_directories(folder);
    for (const auto& [clip, list] : by_clip) {
        std::array<Panel, 3> panels = {Panel("PSNR-Y", left), Panel("SSIM", left + panel_width + gap),
                                       Panel("PSNR-HVS-M", left + 2 * (panel_width + gap))};
        for (const Curve* curve : list) {
            panels[0].add(*curve, [](const Measured& m) { return m.psnr_y; });
            panels[1].add(*curve, [](const Measured& m) { return in_db(m.ssim_y); });
            panels[2].add(*curve, [](const Measured& m) { return m.psnr_hvs_m; });
        }
        const double width = left + 3 * (panel_width + gap), height = top + panel_height + 70;
        std::ofstream out(folder / (clip + ".svg"));
        out << fmt::format(
            "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
            "font-type='sans-serif' font-size='12'><rect width='{0}' height='{1}' fill='#fafafa'/>"
            "<text x='{2}' y='18' font-size='14'>{3}</text>",
            width, height, left, clip);
        for (const Panel& panel : panels) out << panel.svg(colours);
        double x = left;
        for (const Curve* curve : list) {
            out << fmt::format("<rect x='{}' y='{}' width='18' height='4' fill='{}'/><text x='{}' y='{}'>{}</text>", x,
                               height - 20, colours.at(curve->codec), x + 24, height - 14, curve->codec);
            x += 110;
        }
        out << "</svg>\n";
    }
}

}  // namespace render2mpeg::bench
