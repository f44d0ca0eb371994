#include "app/experiments/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/files/file_io.h"
#include "app/report/frame_view.h"
#include "core/numeric.h"
#include "perceptual/bd_rate.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

double in_decibels(double ssim) {
    return -10 * std::log10(std::max(1 - ssim, 1e-9));
}

template <class Cost, class Figure>
double change(const Way& way, const Way& from, Cost&& cost, Figure&& figure) {
    const auto points = [&](const Way& w) {
        std::vector<perceptual::RatePoint> all;
        for (const Trial& t : w.rows)
            if (const double quality = figure(t.film_quality()); cost(t) > 0 && std::isfinite(quality))
                all.push_back({cost(t), quality});
        return all;
    };
    return perceptual::bd_rate(points(from), points(way));
}

/// "12.3 % fewer", "3 % more"
std::string more_text(double per_cent) {
    return fmt::format("{:.1f} % {}", std::abs(per_cent), per_cent < 0 ? "fewer" : "more");
}

json differences_json(const Comparison& found) {
    json all = json::array();
    if (!found.complete) return all;
    for (const auto& [way, from] : held_against) {
        const Difference d = difference_of(found.ways[way], found.ways[from]);
        all.push_back({{"way", found.ways[way].name},
                       {"against", found.ways[from].name},
                       {"bits",
                        {{"psnr_y", finite_or_null(d.psnr_y)},
                         {"ssim_y", finite_or_null(d.ssim_y)},
                         {"psnr_hvs_m", finite_or_null(d.psnr_hvs_m)}}},
                       {"time", finite_or_null(d.seconds)}});
    }
    return all;
}

}  // namespace

const TrialColumns compare_columns{"light_seconds", "code_seconds", "bytes", "psnr_y", "ssim_y", "psnr_hvs_m"};

std::string row_name(const Way& way, const Trial& trial) {
    return fmt::format("{:<18} {:>2}", way.name, trial.quantiser);
}

Choices choices_of(const Way& way, encoder::Codec codec, int quantiser) {
    Choices choices{{"--tolerance", way.tolerance}};
    if (way.ffmpeg)
        choices.insert(choices.end(), {{"-o", "-"}, {"--as", "y4m"}});
    else
        choices.emplace_back(codec == encoder::Codec::mpeg2 ? "--quantiser" : "--crf", std::to_string(quantiser));
    return choices;
}

Difference difference_of(const Way& way, const Way& from) {
    const auto bytes = [](const Trial& t) { return t.bytes; };
    const auto seconds = [](const Trial& t) { return t.seconds + t.code_seconds; };
    const auto psnr = [](const Quality& q) { return q.psnr_y; };
    return {change(way, from, bytes, psnr),
            change(way, from, bytes, [](const Quality& q) { return in_decibels(q.ssim_y); }),
            change(way, from, bytes, [](const Quality& q) { return q.psnr_hvs_m; }), change(way, from, seconds, psnr)};
}

std::vector<WayCost> way_costs(const Comparison& found, std::int64_t frames, std::size_t row) {
    // Mean pace of all that was lit, since the machine's load changes.
    double clock = 0, cpu = 0;
    for (const std::size_t way : {coupled_way, fixed_way})
        for (const Trial& trial : found.ways[way].rows) clock += trial.clock, cpu += trial.cpu;
    const double pace = core::divide_or(clock, cpu, 1.0);
    std::vector<WayCost> costs;
    for (const std::size_t way : {coupled_way, fixed_way, usual_way, strongest_way}) {
        const Difference d = difference_of(found.ways[coupled_way], found.ways[way]);
        if (row >= found.ways[way].rows.size() || (way != coupled_way && !std::isfinite(d.psnr_y))) continue;
        const Trial& trial = found.ways[way].rows[row];
        double frame = trial.cpu;
        // Light of a fixed tolerance was timed with our coding.
        if (way != coupled_way) frame += trial.code_seconds - found.ways[fixed_way].rows[row].code_seconds;
        const double seconds = frame * static_cast<double>(frames);
        costs.push_back({way, way == coupled_way ? 1 : 1 / (1 + d.psnr_y / 100), pace * seconds, seconds});
    }
    std::ranges::stable_sort(costs, {}, &WayCost::bits);
    return costs;
}

std::optional<std::size_t> recommended(const std::vector<WayCost>& costs) {
    // chosen: bits by a few samples scatter by as much (0.5 to 2 %).
    constexpr double same = 1.01;
    std::vector<Offer> offers;
    for (const WayCost& cost : costs) offers.push_back({cost.cpu, cost.bits <= same * costs.front().bits});
    return cheapest_alike(offers);
}

std::size_t row_of(const Comparison& found, int quantiser) {
    const auto& rows = found.ways[coupled_way].rows;
    const auto away = [&](const Trial& t) { return std::abs(t.quantiser - quantiser); };
    return static_cast<std::size_t>(std::ranges::min_element(rows, {}, away) - rows.begin());
}

std::string answer_of(const Comparison& found, std::int64_t frames, int quantiser) {
    if (!found.complete || found.ways[coupled_way].rows.empty()) return {};
    const std::size_t row = row_of(found, quantiser);
    const std::vector<WayCost> costs = way_costs(found, frames, row);
    const std::optional<std::size_t> taken = recommended(costs);
    if (!taken) return {};
    const WayCost& cost = costs[*taken];
    const double bytes = found.ways[cost.way].rows[row].film_bytes * static_cast<double>(frames);
    return fmt::format("Take {}: your film of {} frames takes about {} and has about {} at quantiser {}.",
                       found.ways[cost.way].name, frames, time_text(cost.clock, cost.cpu), size_text(bytes),
                       found.ways[coupled_way].rows[row].quantiser);
}

std::string sentence_of(const Comparison& found) {
    if (!found.complete) return {};
    const Way& coupled = found.ways[coupled_way];
    const Difference usual = difference_of(coupled, found.ways[usual_way]),
                     strongest = difference_of(coupled, found.ways[strongest_way]);
    if (!std::isfinite(usual.psnr_y) || !std::isfinite(strongest.psnr_y))
        return "These films have no quality in common that they could be compared at.";
    std::string text = fmt::format(
        "At equal PSNR-Y the coupled film has {} bits than a fixed 2 % coded by ffmpeg, and {} than by its strongest "
        "command",
        more_text(usual.psnr_y), more_text(strongest.psnr_y));
    if (std::isfinite(usual.seconds) && std::isfinite(strongest.seconds))
        text += fmt::format("; light, motion and coding take {:.2f} and {:.2f} times their time",
                            1 + usual.seconds / 100, 1 + strongest.seconds / 100);
    return text + ".";
}

std::string difference_table(const Comparison& found) {
    std::string text = "\nBits at equal quality, and time at equal PSNR-Y, against a fixed 2 % coded by\n";
    std::optional<std::size_t> last;
    for (const auto& [way, from] : held_against) {
        if (last != from)
            text += fmt::format("{:<28}{:>10} {:>10} {:>10} {:>10}\n", found.ways[from].name, "PSNR-Y", "SSIM", "HVS-M",
                                "time");
        last = from;
        const Difference d = difference_of(found.ways[way], found.ways[from]);
        text += fmt::format("  {:<26}{:>10} {:>10} {:>10} {:>10}\n", found.ways[way].name, change_text(d.psnr_y),
                            change_text(d.ssim_y), change_text(d.psnr_hvs_m), change_text(d.seconds));
    }
    return text;
}

std::string change_text(double per_cent) {
    return std::isfinite(per_cent) ? fmt::format("{:+.1f} %", per_cent) : "-";
}

json compare_json(const RenderJob& film, const Comparison& found) {
    json ways = json::array(), rows = json::array();
    for (const Way& way : found.ways) {
        ways.push_back({{"name", way.name}, {"how", way.how}});
        for (const Trial& trial : way.rows) {
            rows.push_back(figures_json(trial));
            rows.back()["group"] = way.name;
        }
    }
    return {{"ffmpeg", found.ffmpeg},
            {"ways", ways},
            {"rows", rows},
            {"differences", differences_json(found)},
            {"summary", sentence_of(found)},
            {"answer", answer_of(found, film.frame_count(), film.coding.quantiser)},
            {"render", text_or_null(found.render)},
            {"complete", found.complete}};
}

json compare_page(const RenderJob& film, const Comparison& found) {
    const auto& rows = found.ways[coupled_way].rows;
    json page{{"costs", json::array()}, {"pictures", json::array()}};
    page["sample"] =
        sample_frame_figures(fmt::format("coupled, quantiser {}", rows.back().quantiser), rows.back(), film);
    if (!found.complete) return page;
    const std::size_t row = row_of(found, film.coding.quantiser);
    page["quantiser"] = rows[row].quantiser;
    const std::vector<WayCost> costs = way_costs(found, film.frame_count(), row);
    const std::optional<std::size_t> taken = recommended(costs);
    for (std::size_t i = 0; i < costs.size(); ++i)
        page["costs"].push_back({{"way", found.ways[costs[i].way].name},
                                 {"bits", costs[i].bits},
                                 {"clock", costs[i].clock},
                                 {"cpu", costs[i].cpu},
                                 {"recommended", taken == i}});
    const Way& other = found.ways[usual_way];
    if (row < other.rows.size() && rows[row].sample_frame && other.rows[row].sample_frame)
        page["pictures"].push_back(pair_of(fmt::format("Quantiser {}: decoded", rows[row].quantiser),
                                           {"coupled", rows[row].sample_frame->decoded},
                                           {other.name, other.rows[row].sample_frame->decoded}, film.colors(), true));
    return page;
}

}  // namespace render2mpeg::app
