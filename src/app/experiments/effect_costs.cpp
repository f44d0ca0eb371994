#include "app/experiments/effect_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "app/experiments/film_costs.h"
#include "app/loop/forecast.h"
#include "app/report/answer.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "core/numeric.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

/// The longest side of the pictures. chosen: 320, in which every effect is seen, and ten pictures make no large page.
constexpr double longest_side = 320;

/// Times that are less than this share apart are not told apart. chosen: what CPU times of a few frames scatter by.
constexpr double least_share = 0.03;

/// Keeps the pictures of windows' last frames as they are lit.
class Pictures : public LoopObserver {
  public:
    explicit Pictures(const std::vector<Chunk>& windows) : windows_(windows) {}
    void lit(const LitFrame& frame) override {
        for (const Chunk& window : windows_)
            if (frame.world.frame == window.last) all.insert_or_assign(frame.world.frame, frame.picture);
    }

    std::map<std::int64_t, core::Picture> all;

  private:
    const std::vector<Chunk>& windows_;
};

struct Lit {
    double cpu = 0;  ///< for the whole film
    std::map<std::int64_t, core::Picture> pictures;
};

std::optional<Lit> light(const RenderJob& film, const std::vector<Chunk>& windows, const std::string& name,
                         bool quiet) {
    const auto side = static_cast<double>(std::max(film.format.width, film.format.height));
    const RenderJob small = resized(film, std::min(1.0, longest_side / side));
    const auto frames = static_cast<std::int64_t>(windows.size()) * windows.front().frames();
    Progress progress(frames, quiet || !shows_steps(), name, Counted::frames_of_step);
    Pictures pictures(windows);
    const auto sample = sample_frames(small, windows, std::numeric_limits<double>::infinity(), pictures, progress);
    if (!sample) return {};
    return Lit{film_by(film, *sample).seconds, std::move(pictures.all)};
}

EffectCost difference_of(const Lit& whole, const Lit& less) {
    EffectCost cost;
    double masked = 0, most = -1;
    perceptual::FilmQuality quality;
    for (auto& [frame, picture] : less.pictures) {
        const core::Picture& right = whole.pictures.at(frame);
        const double error = perceptual::masked_error(picture.y, right.y);
        quality.add(picture, right);
        masked += error / static_cast<double>(less.pictures.size());
        if (error <= most) continue;
        most = error;
        cost.without = picture;
        cost.whole = right;
    }
    if (masked > 0) cost.difference = perceptual::psnr(masked);
    cost.psnr_y = quality.psnr_y();
    cost.share = 1 - core::divide_or(less.cpu, whole.cpu, 1.0);
    return cost;
}

/// Handler of a row's button: shows its picture and the whole frame in the large figure.
constexpr const char* show_effect =
    "const large = document.querySelector('#effects .pair'), chosen = this.querySelector('img'), both = "
    "large.querySelectorAll('.upon img'); both[0].src = chosen.src; both[1].src = "
    "document.getElementById(this.dataset.whole).src; large.querySelector('.grip span').textContent = chosen.alt; "
    "large.scrollIntoView({ block: 'nearest' })";

AnswerRow row_of(const EffectCost& cost, double longest, perceptual::ColorMatrix matrix) {
    return {cost.name,
            std::max(0.0, core::divide_or(cost.share, longest, 0.0)),
            share_text(cost.share),
            words_for(cost.difference),
            grade_of(cost.difference),
            cost.difference ? fmt::format("{:.0f} dB", *cost.difference) : "the same",
            "",
            false,
            cost.option.empty() ? "" : cost.option + " leaves it out",
            fmt::format("<button class=\"thumb\" data-whole=\"whole-{}\" onclick=\"{}\">{}</button>", cost.whole.number,
                        show_effect, image_of("without " + cost.name, cost.without, matrix))};
}

/// Whole pictures of the rows, each once.
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

std::vector<LeftOut> left_out_of(const RenderJob& film) {
    std::vector<LeftOut> all;
    for (const renderer::PlanRow& row : film.plan.rows())
        if (row.runs && *row.effect != '\0') all.push_back({row.effect, "", without(film, row.pass)});
    const auto add = [&](const char* name, const std::string& option, auto&& leave_out) {
        all.push_back({name, option, film});
        leave_out(all.back().film);
    };
    renderer::Settings r = film.rendering;
    if (film.cache.keeps())
        add("kept light", "--cache off", [](RenderJob& f) { f.rendering.cache = renderer::CacheUse::off; });
    if (film.tolerance.coupled) add("coupling", "--tolerance fixed=2%", [](RenderJob& f) { f.tolerance = {}; });
    if (r.edge_samples > r.samples)
        add("finer edges", fmt::format("--edge-samples {}", r.samples),
            [](RenderJob& f) { f.rendering.edge_samples = f.rendering.most_samples = 0; });
    return all;
}

EffectCosts effect_costs(const RenderJob& film, int frames, double limit, bool quiet,
                         const std::function<void(const EffectCost&, bool)>& row_done) {
    EffectCosts costs;
    std::vector<LeftOut> effects = left_out_of(film);
    costs.left = static_cast<int>(effects.size());
    const std::vector<Chunk> windows = middle_windows(film, 1, frames);
    if (clock_seconds() > limit) return costs;
    const std::optional<Lit> whole = light(film, windows, "all effects", quiet);
    if (!whole) return costs;
    const core::Picture& picture = whole->pictures.begin()->second;
    costs.size = {picture.width(), picture.height()};
    costs.frames = static_cast<int>(windows.front().frames());
    for (const LeftOut& effect : effects) {
        if (clock_seconds() > limit) break;
        const std::optional<Lit> less = light(effect.film, windows, "without " + effect.name, quiet);
        if (!less) break;
        EffectCost cost = difference_of(*whole, *less);
        cost.name = effect.name;
        cost.option = effect.option;
        row_done(cost, costs.rows.empty());
        costs.rows.push_back(std::move(cost));
        --costs.left;
    }
    return costs;
}

std::string share_text(double share) {
    if (std::abs(share) < least_share) return fmt::format("under {:.0f} %", 100 * least_share);
    return fmt::format("{}{:.0f} %", share < 0 ? "saves " : "", 100 * std::abs(share));
}

std::string effects_heading() {
    return fmt::format("\nWhat each effect takes, and what one sees where it is left out\n{:<32} {:>10}  {}\n",
                       "effect", "time", "without it");
}

std::string effect_row(const EffectCost& cost) {
    const std::string name = cost.name + (cost.option.empty() ? "" : " (" + cost.option + ")");
    return fmt::format("{:<32} {:>10}  {}{}\n", name, share_text(cost.share), words_for(cost.difference),
                       cost.difference ? fmt::format(" ({:.0f} dB)", *cost.difference) : "");
}

std::string effects_section(const EffectCosts& effects, perceptual::ColorMatrix matrix) {
    if (effects.rows.empty()) return {};
    double longest = 0;
    const EffectCost* first = &effects.rows.front();
    for (const EffectCost& cost : effects.rows) longest = std::max(longest, cost.share);
    // Begin with the dearest one, unless hardly anything is left without it. chosen: 10 dB.
    const auto rank = [](const EffectCost& cost) { return cost.difference.value_or(99) < 10 ? -1 : cost.share; };
    for (const EffectCost& cost : effects.rows)
        if (rank(cost) > rank(*first)) first = &cost;
    std::vector<AnswerRow> rows;
    for (const EffectCost& cost : effects.rows) rows.push_back(row_of(cost, longest, matrix));
    const std::string table = answer_table(
        {"effect", "share of time", "difference without it", "without it"}, rows,
        fmt::format("From {} frame{} of {}x{}, lit again without each effect. Shares need not add up: effects share "
                    "work. dB: PSNR-HVS-M of the lit pictures with and without it. Choose a picture to see it beside "
                    "the whole.",
                    effects.frames, effects.frames == 1 ? "" : "s", effects.size.width, effects.size.height));
    const std::string figure =
        slider_figure(fmt::format("Frame {}", first->whole.number), {"without " + first->name, first->without},
                      {"all effects", first->whole}, matrix);
    return "<h2>What each effect takes, and what it gives</h2>\n<div id=\"effects\">" +
           answer_screen(table, figure, "") + whole_images(effects, matrix) + "</div>\n";
}

}  // namespace render2mpeg::app
