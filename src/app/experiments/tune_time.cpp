// `tune` for a time: probes with less and less light.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/experiments/trial_command.h"
#include "app/experiments/tuning.h"
#include "perceptual/tolerance_fraction.h"

namespace render2mpeg::app {
namespace {

/// One way to light the film: the less, the less it takes.
struct Rung {
    ToleranceRequest tolerance;
    int samples = 0, vpls = 0;
    std::vector<std::pair<std::string, std::string>> options;  ///< that differ from what was asked for
    std::string name;
};

ToleranceRequest loosened(const ToleranceRequest& asked, float factor) {
    ToleranceRequest tolerance = asked;
    tolerance.reference = false;
    // chosen: what is asked without clustering is first lit as films are; a pixel's luminance is the end of all shares.
    if (asked.reference) tolerance.coupled = true;
    if (tolerance.coupled)
        tolerance.fraction = std::min(asked.fraction.value_or(perceptual::default_tolerance_fraction) * factor, 100.0f);
    else
        tolerance.relative = std::min(std::max(asked.relative, 0.0025f) * factor, 0.5f);
    return tolerance;
}

std::string text_of(const ToleranceRequest& t) {
    return t.coupled ? fmt::format("coupled={:.3g}", *t.fraction) : fmt::format("fixed={:.3g}%", 100 * t.relative);
}

/// From what was asked for to next to nothing.
/// chosen: in this order steps cost least of the picture (docs/fits/coupled-share.md, "Steps of tune"): tolerances up
/// to four times what hides, then edges, then light points, whose light is another one; four steps of each.
std::vector<Rung> ladder_of(const ToleranceRequest& tolerance, int samples, int vpls) {
    std::vector<Rung> rungs;
    const auto add = [&](float factor, int fewer_samples, int fewer_points) {
        Rung rung;
        rung.tolerance = factor > 1 ? loosened(tolerance, factor) : tolerance;
        rung.samples = std::max(1, samples / fewer_samples);
        rung.vpls = vpls == 0 ? 0 : std::max(std::min(vpls, 64), vpls / fewer_points);
        if (factor > 1) rung.options.emplace_back("--tolerance", text_of(rung.tolerance));
        if (rung.samples != samples) rung.options.emplace_back("--samples", std::to_string(rung.samples));
        if (rung.vpls != vpls) rung.options.emplace_back("--vpls", std::to_string(rung.vpls));
        for (const auto& [name, value] : rung.options)
            rung.name += (rung.name.empty() ? "" : ", ") + name.substr(2) + " " + value;
        if (rung.name.empty()) rung.name = "as asked for";
        if (rungs.empty() || rung.options != rungs.back().options) rungs.push_back(std::move(rung));
    };
    add(1, 1, 1);
    add(2, 1, 1);
    add(4, 1, 1);
    add(4, 4, 1);
    add(4, 4, 4);
    add(8, 16, 16);
    return rungs;
}

/// The film as a rung has it.
RenderJob on_rung(const RenderJob& film, const Rung& rung) {
    RenderJob changed = film;
    changed.tolerance = rung.tolerance;
    changed.rendering.samples = rung.samples;
    changed.rendering.vpls = rung.vpls;
    return changed;
}

class TimeTuner {
  public:
    TimeTuner(Trials& trials, const RenderOptions& asked, double once, bool quiet, Tuning& tuning,
              const TellProbe& tell)
        : trials_(trials),
          once_(once),
          quiet_(quiet),
          tuning_(tuning),
          tell_(tell),
          rungs_(ladder_of(trials.film().tolerance, asked.samples, asked.vpls)) {
        if (asked.coding.quality)
            coarseness_ = Coarseness::of_quality(*asked.coding.quality);
        else
            coarseness_ = Coarseness(trials.film().coding.quantiser);
    }

    void settle();

  private:
    /// Whether the film would be done in time on that rung; none: interrupted.
    std::optional<bool> fits(std::size_t index);

    Trials& trials_;
    double once_;
    bool quiet_;
    Tuning& tuning_;
    const TellProbe& tell_;
    std::vector<Rung> rungs_;
    Coarseness coarseness_;
};

std::optional<bool> TimeTuner::fits(std::size_t index) {
    const Rung& rung = rungs_[index];
    const RenderJob& film = trials_.film();
    std::optional<Trials> other;
    if (rung.samples != film.rendering.samples || rung.vpls != film.rendering.vpls) {
        other.emplace(on_rung(film, rung), trials_.windows(), 0);
        other->take_references(trials_);
    }
    const auto trial = run_trial(other ? *other : trials_, rung.tolerance, coarseness_, rung.name, quiet_);
    if (!trial) return std::nullopt;
    const double seconds = once_ + trial->clock * static_cast<double>(film.frame_count());
    tuning_.probes.push_back({rung.name, *trial, seconds, true});
    tell_(tuning_.probes.back());

    // Of those that are done in time, the best picture is taken.
    const bool in_time = seconds <= tuning_.target.value;
    const auto psnr = [&](std::size_t i) {
        return quality_of(tuning_.probes[i].trial, tuning_.against_references()).psnr_y;
    };
    const std::size_t last = tuning_.probes.size() - 1;
    const bool had_one = tuning_.chosen && tuning_.found == Found::near;
    if (in_time ? !had_one || psnr(last) > psnr(*tuning_.chosen)
                : !had_one && (!tuning_.chosen || seconds < tuning_.probes[*tuning_.chosen].value)) {
        tuning_.chosen = last;
        tuning_.options = rung.options;
        tuning_.found = in_time ? Found::near : Found::stopped;
    }
    return in_time;
}

void TimeTuner::settle() {
    const auto stopped = [&] { tuning_.found = Found::stopped; };
    const std::optional<bool> whole = fits(0);
    if (!whole) return stopped();
    if (*whole) return;
    const std::optional<bool> least = rungs_.size() > 1 ? fits(rungs_.size() - 1) : std::optional(false);
    if (!least) return stopped();
    if (!*least) {
        tuning_.found = Found::beyond;
        return;
    }
    std::size_t slow = 0, fast = rungs_.size() - 1;
    while (fast - slow > 1) {
        const std::size_t middle = (slow + fast) / 2;
        const std::optional<bool> in_time = fits(middle);
        if (!in_time) return stopped();
        (*in_time ? fast : slow) = middle;
    }
}

}  // namespace

void tune_time(Trials& trials, const RenderOptions& asked, double once, bool quiet, Tuning& tuning,
               const TellProbe& tell) {
    TimeTuner(trials, asked, once, quiet, tuning, tell).settle();
}

}  // namespace render2mpeg::app
