#include "app/experiments/effect_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "app/experiments/film_costs.h"
#include "app/loop/forecast.h"
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

}  // namespace render2mpeg::app
