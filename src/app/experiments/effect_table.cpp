#include "app/experiments/effect_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "app/experiments/film_costs.h"
#include "app/report/answer.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"

namespace render2mpeg::app {
namespace {

/// Of a row's button: puts its picture, and the whole of the same frame, into the large figure.
constexpr const char* show_effect =
    "const large = document.querySelector('#effects .pair'), chosen = this.querySelector('img'), both = "
    "large.querySelectorAll('.upon img'); both[0].src = chosen.src; both[1].src = "
    "document.getElementById(this.dataset.whole).src; large.querySelector('.grip span').textContent = chosen.alt; "
    "large.scrollIntoView({ block: 'nearest' })";

constexpr const char* grades[] = {"good", "fair", "poor", "plain"};

std::string row_of(const EffectCost& cost, double longest, perceptual::ColorMatrix matrix) {
    const std::string option =
        cost.option.empty() ? "" : "<br/><small>" + escaped(cost.option) + " leaves it out</small>";
    // What saves time has no bar.
    const std::string bar =
        cost.share > 0 && longest > 0
            ? fmt::format("<div class=\"len\" style=\"width:{:.1f}%\"></div>", 100 * cost.share / longest)
            : "";
    return fmt::format(
        "<tr><td>{}{}</td><td class=\"bars\">{}{}</td><td><span "
        "class=\"{}\">{}</span><br/><small>{}</small></td><td><button class=\"thumb\" data-whole=\"whole-{}\" "
        "onclick=\"{}\">{}</button></td></tr>\n",
        escaped(cost.name), option, bar, share_text(cost.share), grades[static_cast<int>(grade_of(cost.difference))],
        words_for(cost.difference), cost.difference ? fmt::format("{:.0f} dB", *cost.difference) : "the same",
        cost.whole.number, show_effect, image_of("without " + cost.name, cost.without, matrix));
}

/// The wholes that rows ask for, each once.
std::string whole_images(const EffectCosts& effects, perceptual::ColorMatrix matrix) {
    std::map<std::int64_t, const core::Picture*> wholes;
    for (const EffectCost& cost : effects.rows) wholes.emplace(cost.whole.number, &cost.whole);
    std::string text;
    for (const auto& [number, picture] : wholes)
        text += fmt::format("<div hidden>{}</div>\n",
                            image_of("all effects", *picture, matrix, fmt::format("whole-{}", number)));
    return text;
}

}  // namespace

std::string effects_section(const EffectCosts& effects, perceptual::ColorMatrix matrix) {
    if (effects.rows.empty()) return {};
    double longest = 0;
    const EffectCost* first = &effects.rows.front();
    for (const EffectCost& cost : effects.rows) longest = std::max(longest, cost.share);
    // Begin with the dearest one, unless hardly anything is left without it. chosen: 10 dB.
    const auto rank = [](const EffectCost& cost) { return cost.difference.value_or(99) < 10 ? -1 : cost.share; };
    for (const EffectCost& cost : effects.rows)
        if (rank(cost) > rank(*first)) first = &cost;
    std::string table =
        "<table class=\"answer\">\n<tr><th>effect</th><th>share of time</th><th>difference "
        "without it</th><th>without it</th></tr>\n";
    for (const EffectCost& cost : effects.rows) table += row_of(cost, longest, matrix);
    table += fmt::format(
        "</table>\n<p class=\"soft\">From {} frame{} of {}x{}, lit again without each effect. Shares need not add up: "
        "effects share work. dB: PSNR-HVS-M of the lit pictures with and without it. Choose a picture to see it beside "
        "the whole.</p>\n",
        effects.frames, effects.frames == 1 ? "" : "s", effects.size.width, effects.size.height);
    const std::string figure =
        slider_figure(fmt::format("Frame {}", first->whole.number), {"without " + first->name, first->without},
                      {"all effects", first->whole}, matrix);
    return "<h2>What each effect takes, and what it gives</h2>\n<div id=\"effects\">" +
           answer_screen(table, figure, "") + whole_images(effects, matrix) + "</div>\n";
}

}  // namespace render2mpeg::app
