#include "app/experiments/film_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/files/file_io.h"
#include "app/report/frame_view.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "core/numeric.h"
#include "parallel/loops.h"
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
    const Sample small{resized(film, scale_for(film, longest_side)), {windows, {}}};
    Progress progress(small.windows.frames(), quiet || !shows_steps(), name, Counted::frames_of_step);
    Pictures pictures(windows);
    const auto sample = sample_frames(small, pictures, progress);
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

namespace {

/// [Ponomarenko2007]: below some 42 dB differences are seen. chosen: 4 and 8 dB more for errors that are not even.
constexpr double invisible = 50, hardly = 46, slight = 42;

constexpr const char* by_truth = "truth";

using nlohmann::json;

struct Base {
    double cpu = 0, bytes = 0;  ///< of the film, for one of the sample's frame
    double pace = 0;            ///< seconds on the clock for one of CPU
};

/// The film as asked for is coupled: its forecast is that row's.
Base base_of(const Sweep& sweep, double frames) {
    const auto asked = std::ranges::find(sweep.rows, std::string(Sweep::coupled), &TrialRow::group);
    if (!sweep.forecast || asked == sweep.rows.end()) {
        // Mean pace of all rows, since the machine's load changes.
        double clock = 0, cpu = 0;
        for (const TrialRow& row : sweep.rows) clock += row.trial.clock, cpu += row.trial.cpu;
        return {frames, frames, core::divide_or(clock, cpu, 1.0)};
    }
    const Forecast& f = *sweep.forecast;
    return {core::divide_or(f.cpu, asked->trial.cpu, frames), core::divide_or(f.bytes, asked->trial.film_bytes, frames),
            core::divide_or(f.clock, f.cpu, 1.0)};
}

/// The trial of a film's row; null for paths.
const TrialRow* row_of(const Sweep& sweep, const FilmCost& cost) {
    const auto found = std::ranges::find_if(sweep.rows, [&](const TrialRow& row) {
        return row.name == cost.value && (row.group == Sweep::effort) == (cost.option == "--effort");
    });
    return found == sweep.rows.end() ? nullptr : &*found;
}

/// One frame by each row of the film's table, null where there is none, beside exact light; null without references.
json accuracies_json(const Sweep& sweep, const std::vector<FilmCost>& costs, const perceptual::PictureColors& colors) {
    json sources = json::array(), shown = nullptr;
    for (const FilmCost& cost : costs) {
        const TrialRow* const row = row_of(sweep, cost);
        sources.push_back(nullptr);
        if (row == nullptr || !row->trial.sample_frame) continue;
        const SampleFrame& frame = *row->trial.sample_frame;
        sources.back() = source_of(cost.name(), frame.lit, colors);
        if (shown.is_null())
            shown = {{"frame", frame.frame},
                     {"width", shown_width(frame.lit.width())},
                     {"exact", source_of("exact", frame.reference, colors)}};
    }
    if (!shown.is_null()) shown["sources"] = sources;
    return shown;
}

json film_json(const std::vector<FilmCost>& costs) {
    json film = json::array();
    const std::optional<std::size_t> taken = recommended(costs);
    for (std::size_t i = 0; i < costs.size(); ++i)
        film.push_back({{"option", costs[i].option},
                        {"value", costs[i].value},
                        {"clock", costs[i].clock},
                        {"cpu", costs[i].cpu},
                        {"bytes", costs[i].bytes},
                        {"difference", costs[i].difference()},
                        {"added_psnr_hvs_m", finite_or_null(costs[i].added)},
                        {"psnr_y_loss", costs[i].psnr_loss},
                        {"recommended", taken == i}});
    return film;
}

json effects_json(const EffectCosts& effects) {
    json rows = json::array();
    for (const EffectCost& e : effects.rows)
        rows.push_back({{"effect", e.name},
                        {"option", text_or_null(e.option)},
                        {"time_share", e.share},
                        {"difference", words_for(e.difference)},
                        {"psnr_hvs_m", finite_or_null(e.difference)},
                        {"psnr_y", finite_or_null(e.psnr_y)}});
    return {{"width", effects.size.width}, {"height", effects.size.height}, {"frames", effects.frames}, {"rows", rows}};
}

}  // namespace

const TrialColumns cost_columns{"light_seconds",  "rays_per_point", "cut",    "error_p50", "error_p95",
                                "over_tolerance", "psnr_y",         "ssim_y", "bytes"};

const Trial* Sweep::best() const {
    const Trial* best = nullptr;
    for (const TrialRow& row : rows)
        if (row.group == fixed) best = &row.trial;
    return best;
}

std::string FilmCost::difference() const {
    if (value == by_truth) return fmt::format("exact, by paths to {} %", PathTruth::percent);
    return words_for(added) + (psnr_loss < 0.005 ? "" : fmt::format(" (-{:.2f} dB)", psnr_loss));
}

std::string words_for(const std::optional<double>& added) {
    if (!added || *added >= invisible) return "none you can see";
    if (*added >= hardly) return "hardly any";
    return *added >= slight ? "slight in flat areas" : "visible";
}

std::vector<FilmCost> film_costs(const Sweep& sweep, std::int64_t frame_count) {
    std::vector<FilmCost> costs;
    if (sweep.best() == nullptr) return costs;
    const Trial& best = *sweep.best();
    const auto frames = static_cast<double>(frame_count);
    const Base base = base_of(sweep, frames);
    for (const TrialRow& row : sweep.rows) {
        const Trial& trial = row.trial;
        const double added = trial.masked_error - best.masked_error;
        const double loss = best.film_quality().psnr_y - trial.film_quality().psnr_y;
        costs.push_back({row.group == Sweep::effort ? "--effort" : "--tolerance", row.name,
                         base.pace * base.cpu * trial.cpu, base.cpu * trial.cpu, base.bytes * trial.film_bytes,
                         added > 0 ? std::optional(perceptual::psnr(added)) : std::nullopt,
                         std::isfinite(loss) ? std::max(0.0, loss) : 0.0});
    }
    if (sweep.truth) {
        const double cpu = frames * sweep.pixels * sweep.truth->share * sweep.truth->seconds +
                           base.cpu * std::max(0.0, best.cpu - best.seconds);
        costs.push_back({"--tolerance", by_truth, base.pace * cpu, cpu, base.bytes * best.film_bytes, {}, 0});
    }
    std::ranges::stable_sort(costs, {}, &FilmCost::cpu);
    return costs;
}

std::optional<std::size_t> recommended(const std::vector<FilmCost>& costs) {
    std::vector<Offer> offers;
    for (const FilmCost& cost : costs) offers.push_back({cost.cpu, !cost.added || *cost.added >= invisible});
    return cheapest_alike(offers);
}

std::string answer_of(const std::vector<FilmCost>& costs, std::int64_t frames) {
    const std::optional<std::size_t> taken = recommended(costs);
    if (!taken) return {};
    const FilmCost& here = costs[*taken];
    return fmt::format(
        "Take {}: your film of {} frames takes about {} and has about {}; the difference from exact light: {}.",
        here.name(), frames, time_text(here.clock, here.cpu), size_text(here.bytes), words_for(here.added));
}

std::string film_cost_table(const std::vector<FilmCost>& costs) {
    const std::optional<std::size_t> taken = recommended(costs);
    std::string text =
        fmt::format("\nThe whole film on this machine's {} threads\n{:<14} {:>8} {:>8} {:>9}  {}\n",
                    parallel::thread_count(), "setting", "clock", "CPU, s", "size", "difference from exact light");
    for (std::size_t i = 0; i < costs.size(); ++i)
        text +=
            fmt::format("{:<14} {:>8} {:>8.0f} {:>9}  {}{}\n", costs[i].name(), clock_text(costs[i].clock),
                        costs[i].cpu, size_text(costs[i].bytes), costs[i].difference(), taken == i ? " <- take" : "");
    return text;
}

json cost_json(const Sweep& sweep, const std::vector<FilmCost>& costs, std::int64_t frames) {
    json rows = json::array();
    for (const TrialRow& row : sweep.rows) {
        rows.push_back(figures_json(row.trial));
        rows.back().update({{"group", row.group}, {"name", row.name}});
    }
    return {{"rows", rows},
            {"film", film_json(costs)},
            {"render", text_or_null(sweep.render)},
            {"effects", effects_json(sweep.effects)},
            {"summary", answer_of(costs, frames)},
            {"complete", sweep.complete}};
}

json cost_page(const RenderJob& film, const Sweep& sweep, const std::vector<FilmCost>& costs) {
    const perceptual::PictureColors colors = film.colors();
    const std::optional<std::size_t> taken = recommended(costs);
    const TrialRow* own = taken ? row_of(sweep, costs[*taken]) : nullptr;
    const TrialRow& row = own != nullptr ? *own : sweep.rows.front();
    json without = json::array(), wholes = json::object();
    for (const EffectCost& cost : sweep.effects.rows) {
        without.push_back({{"source", source_of("without " + cost.name, cost.without, colors)},
                           {"width", shown_width(cost.without.width())},
                           {"frame", cost.whole.number}});
        wholes.emplace(std::to_string(cost.whole.number), source_of("all effects", cost.whole, colors));
    }
    return {{"threads", parallel::thread_count()},
            {"truth", truth_text(sweep.truth)},
            {"accuracies", accuracies_json(sweep, costs, colors)},
            {"without", without},
            {"wholes", wholes},
            {"sample", sample_frame_figures(row.name, row.trial, film)}};
}

}  // namespace render2mpeg::app
