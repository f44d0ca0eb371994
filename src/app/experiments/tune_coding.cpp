// `tune` for a quality or a rate: probes of coding.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "app/experiments/quality_search.h"
#include "app/experiments/trial_command.h"
#include "app/experiments/tuning.h"
#include "app/system/interrupt.h"

namespace render2mpeg::app {
namespace {

/// chosen: light coupled to another quantiser errs by less than a probe's steps after the second time; more than four
/// have not been seen (3..6).
constexpr int most_lightings = 5;
/// chosen: eight probes halve what is left to less than two roundings of quantisers (6..12).
constexpr int most_codings = 10;
/// Where the search begins: quantiser 4, which is the usual one.
constexpr double first_quality = 60;
/// chosen: what is coded again aims closer than what is asked for, so that light made for it may still differ
/// (0.2..0.7).
constexpr double close = 0.4;

std::string setting_of(double quality) {
    return fmt::format("{:.1f}", quality);
}

class CodingTuner {
  public:
    CodingTuner(Trials& trials, const Target& target, bool quiet, Tuning& tuning, const TellProbe& tell)
        : trials_(trials),
          target_(target),
          quiet_(quiet),
          tuning_(tuning),
          tell_(tell),
          lit_(even_figure(target, target.value), even_slope(target)) {}

    void settle();

  private:
    double figure(const Probe& probe) const { return even_figure(target_, probe.value); }
    const Probe& add(double quality, Trial trial, bool lit);
    /// Codes one light again until that meets the target, and returns the quality to be taken.
    double coded_again(const LitWindows& light, QualitySearch search);
    /// Takes what is known when no quality is left to be lit.
    void conclude();

    Trials& trials_;
    const Target& target_;
    bool quiet_;
    Tuning& tuning_;
    const TellProbe& tell_;
    QualitySearch lit_;  ///< what was lit for its own coding
};

const Probe& CodingTuner::add(double quality, Trial trial, bool lit) {
    Probe probe{setting_of(quality), std::move(trial), 0, lit};
    probe.value = value_of(target_, probe.trial, trials_.film().rate.hertz.value(), tuning_.against_references());
    tuning_.probes.push_back(std::move(probe));
    tell_(tuning_.probes.back());
    return tuning_.probes.back();
}

double CodingTuner::coded_again(const LitWindows& light, QualitySearch search) {
    for (int i = 0; i < most_codings && !InterruptGuard::requested(); ++i) {
        const std::optional<double> quality = search.next();
        if (!quality) break;
        const Probe& probe = add(*quality, trials_.coded_again(light, Coarseness::of_quality(*quality)), false);
        search.add(*quality, figure(probe));
        // After three tries a step of the quantisers is in the way: near enough is near.
        if (is_near(target_, probe.value, i < 3 ? close : 0.8)) break;
    }
    // Between two steps: a rate is not exceeded, a quality is reached.
    const QualitySearch::Known nearest = search.nearest();
    const std::optional<QualitySearch::Known> side =
        target_.is_rate() ? search.finest_below() : search.coarsest_above();
    const bool steps = !search.next().has_value();
    return steps && side ? side->quality : nearest.quality;
}

void CodingTuner::settle() {
    const bool coupled = trials_.film().tolerance.coupled;
    double quality = first_quality;
    for (int i = 0; i < most_lightings; ++i) {
        LitWindows light;
        const auto trial = run_trial(trials_, trials_.film().tolerance, Coarseness::of_quality(quality),
                                     "quality " + setting_of(quality), quiet_, &light);
        if (!trial) return;
        const Probe& probe = add(quality, *trial, true);
        lit_.add(quality, figure(probe));
        if (is_near(target_, probe.value)) break;

        QualitySearch search =
            coupled && i == 0 ? lit_ : QualitySearch(even_figure(target_, target_.value), even_slope(target_));
        search.add(quality, figure(probe));
        const double next = coded_again(light, search);
        if (InterruptGuard::requested()) return;
        if (!coupled) break;
        // What was lit for its own coding already is not lit again: then by what such light came to.
        bool known = false;
        for (const QualitySearch::Known& k : lit_.known())
            known = known || std::abs(k.quality - next) < 0.5 * QualitySearch::step;
        const std::optional<double> instead = known ? lit_.next() : next;
        if (!instead) break;
        quality = *instead;
    }
    conclude();
}

void CodingTuner::conclude() {
    // Of a fixed tolerance every coding has the light it would have.
    const bool coupled = trials_.film().tolerance.coupled;
    std::optional<std::size_t> nearest, side;
    const auto distance = [&](std::size_t i) {
        return std::abs(figure(tuning_.probes[i]) - even_figure(target_, target_.value));
    };
    for (std::size_t i = 0; i < tuning_.probes.size(); ++i) {
        const Probe& probe = tuning_.probes[i];
        if (coupled && !probe.lit) continue;
        // Of several that are as near the last, which is nearest to the end that the search went to.
        if (!nearest || distance(i) <= distance(*nearest)) nearest = i;
        const bool right = target_.is_rate() ? probe.value <= target_.value : probe.value >= target_.value;
        if (right && (!side || distance(i) <= distance(*side))) side = i;
    }
    const bool near = is_near(target_, tuning_.probes[*nearest].value);
    tuning_.chosen = near || !side ? nearest : side;
    // Beyond reach is only what the finest and the coarsest do not reach.
    const double quality = *tuning_.probes[*tuning_.chosen].trial.quality;
    const bool finer = figure(tuning_.probes[*tuning_.chosen]) < even_figure(target_, target_.value);
    // Where even the coarsest loses nothing, as of a black film, there is nothing to be looked for.
    const bool at_end =
        finer ? quality >= 100 : quality <= 0 && !is_lossless(target_, tuning_.probes[*tuning_.chosen].value);
    tuning_.found = near ? Found::near : at_end ? Found::beyond : Found::between;
}

}  // namespace

void tune_coding(Trials& trials, const Target& target, bool quiet, Tuning& tuning, const TellProbe& tell) {
    CodingTuner(trials, target, quiet, tuning, tell).settle();
}

}  // namespace render2mpeg::app
