#include "app/experiments/tuning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "app/report/figures.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"

namespace render2mpeg::app {

void QualitySearch::add(double quality, double figure) {
    known_.insert(std::ranges::lower_bound(known_, quality, {}, &Known::quality), {quality, figure});
}

std::optional<double> QualitySearch::next() const {
    if (known_.empty()) return std::nullopt;
    const auto in_steps = [](double quality) { return std::round(quality / step) * step; };
    const auto upper = std::ranges::find_if(known_, [&](const Known& k) { return k.figure >= target_; });
    if (upper == known_.end() || upper == known_.begin()) {
        const double end = upper == known_.end() ? known_.back().quality : known_.front().quality;
        const double bound = upper == known_.end() ? 100 : 0;
        if (std::abs(end - bound) < 0.5 * step) return std::nullopt;
        // Half of the rest, then all of it.
        return known_.size() > 1 ? bound : in_steps(0.5 * (end + bound));
    }
    const Known &low = *std::prev(upper), &high = *upper;
    const double width = high.quality - low.quality;
    if (width < 1.5 * step) return std::nullopt;
    // chosen: four probes tell whether the film follows a line (3..6); not too near to either end.
    const double share = known_.size() > 4 ? 0.5 : (target_ - low.figure) / (high.figure - low.figure);
    const double at = in_steps(low.quality + std::clamp(share, 0.1, 0.9) * width);
    return std::clamp(at, low.quality + step, high.quality - step);
}

const QualitySearch::Known& QualitySearch::nearest() const {
    EXPECTS(!known_.empty());
    return *std::ranges::min_element(known_, {}, [&](const Known& k) { return std::abs(k.figure - target_); });
}

std::optional<QualitySearch::Known> QualitySearch::coarsest_above() const {
    for (const Known& k : known_)
        if (k.figure >= target_) return k;
    return std::nullopt;
}

std::optional<QualitySearch::Known> QualitySearch::finest_below() const {
    for (auto k = known_.rbegin(); k != known_.rend(); ++k)
        if (k->figure <= target_) return *k;
    return std::nullopt;
}

namespace {

/// PSNR of equal pictures: beyond any 8-bit error.
constexpr double same = 100;

/// chosen: light coupled to another quantiser errs by less than a probe's steps after the second time; more than four
/// have not been seen (3..6).
constexpr int most_lightings = 5;
/// chosen: eight probes halve what is left to less than two roundings of quantisers (6..12).
constexpr int most_codings = 10;
/// First quality of the search: quantiser 4, the default.
constexpr double first_quality = 60;
/// chosen: what is coded again aims closer than what is asked for, so that light made for it may still differ
/// (0.2..0.7).
constexpr double close = 0.4;

Setting setting_of(const RenderJob& film, double quality) {
    const std::string value = fmt::format("{:.1f}", quality);
    return {"quality " + value, {{"--quality", value}}, at_quality(film, quality)};
}

class CodingTuner {
  public:
    CodingTuner(Trials& trials, const Target& target, bool quiet, Tuning& tuning, const LogProbe& log)
        : trials_(trials), target_(target), quiet_(quiet), tuning_(tuning), log_(log) {}

    void settle();

  private:
    double figure(const Probe& probe) const { return even_figure(target_, probe.value); }
    bool is_right(const Probe& probe) const {
        return target_.is_rate() ? probe.value <= target_.value : probe.value >= target_.value;
    }
    Probe add(Tried tried, bool lit);
    /// The quality that meets the target with this light, made for `quality`.
    double coded_again(const LitWindows& light, double quality, const Probe& lit);
    /// Concludes where no quality is left to be lit.
    void conclude();

    Trials& trials_;
    const Target& target_;
    bool quiet_;
    Tuning& tuning_;
    const LogProbe& log_;
};

Probe CodingTuner::add(Tried tried, bool lit) {
    const double value = value_of(target_, tried.trial);
    tuning_.probes.push_back({std::move(tried), value, lit});
    log_(tuning_.probes.back());
    return tuning_.probes.back();
}

double CodingTuner::coded_again(const LitWindows& light, double quality, const Probe& lit) {
    QualitySearch search(even_figure(target_, target_.value));
    search.add(quality, figure(lit));
    for (int i = 0; i < most_codings && !InterruptGuard::requested(); ++i) {
        const std::optional<double> next = search.next();
        if (!next) break;
        const Setting setting = setting_of(trials_.film(), *next);
        const Trial trial = told("coding", quiet_, [&] { return trials_.coded_again(light, setting.film); });
        const Probe probe = add({setting.name, setting.choices, trial}, false);
        search.add(*next, figure(probe));
        // After three tries a quantiser step is in the way.
        if (is_near(target_, probe.value, i < 3 ? close : 0.8)) break;
    }
    // Between two steps: a rate is not exceeded, a quality is reached.
    const std::optional<QualitySearch::Known> side =
        target_.is_rate() ? search.finest_below() : search.coarsest_above();
    return !search.next() && side ? side->quality : search.nearest().quality;
}

void CodingTuner::settle() {
    double quality = first_quality;
    std::vector<double> lit;
    for (int i = 0; i < most_lightings; ++i) {
        LitWindows light;
        const auto tried = run_trial(trials_, setting_of(trials_.film(), quality), quiet_, &light);
        if (!tried) return;
        const Probe probe = add(*tried, true);
        lit.push_back(quality);
        if (is_near(target_, probe.value)) break;
        quality = coded_again(light, quality, probe);
        if (InterruptGuard::requested()) return;
        // Light of a fixed tolerance is right for every coding.
        const bool known =
            std::ranges::any_of(lit, [&](double q) { return std::abs(q - quality) < 0.5 * QualitySearch::step; });
        if (known || !trials_.film().tolerance.coupled) break;
    }
    conclude();
}

void CodingTuner::conclude() {
    const bool coupled = trials_.film().tolerance.coupled;
    std::optional<std::size_t> nearest, side;
    const auto distance = [&](std::size_t i) {
        return std::abs(figure(tuning_.probes[i]) - even_figure(target_, target_.value));
    };
    for (std::size_t i = 0; i < tuning_.probes.size(); ++i) {
        const Probe& probe = tuning_.probes[i];
        if (coupled && !probe.lit) continue;
        // Of equally near ones the last, which the search approached.
        if (!nearest || distance(i) <= distance(*nearest)) nearest = i;
        if (is_right(probe) && (!side || distance(i) <= distance(*side))) side = i;
    }
    const bool near = is_near(target_, tuning_.probes[*nearest].value);
    tuning_.chosen = near || !side ? nearest : side;
    // Only the finest and the coarsest can be beyond reach.
    const double quality = *tuning_.probes[*tuning_.chosen].trial.quality;
    const bool finer = figure(tuning_.probes[*tuning_.chosen]) < even_figure(target_, target_.value);
    // A film that loses nothing even at the coarsest, such as a black one.
    const bool at_end =
        finer ? quality >= 100 : quality <= 0 && !is_lossless(target_, tuning_.probes[*tuning_.chosen].value);
    tuning_.found = near ? Found::near : at_end ? Found::beyond : Found::between;
}

/// Largest loss of a step, dB, and the power of tolerances that losses follow (docs/model/tolerance.md#the-price).
constexpr double most_loss = 6, noise_power = 1.6;

ToleranceRequest loosened(const ToleranceRequest& asked, float factor) {
    ToleranceRequest tolerance = asked;
    tolerance.reference = false;
    tolerance.truth.reset();
    // chosen: what is asked without clustering is first lit as films are; a pixel's luminance is the end of all shares.
    if (asked.reference) tolerance.coupled = true;
    if (tolerance.coupled && tolerance.fraction)
        tolerance.fraction = std::min(*asked.fraction * factor, 100.0f);
    else if (tolerance.coupled)
        tolerance.loss = std::min(asked.loss * std::pow(factor, noise_power), most_loss);
    else
        tolerance.relative = std::min(std::max(asked.relative, 0.0025f) * factor, 0.5f);
    return tolerance;
}

std::string text_of(const ToleranceRequest& t) {
    if (t.coupled) return t.fraction ? fmt::format("coupled={:.3g}", *t.fraction) : fmt::format("{:.3g}", t.loss);
    return fmt::format("fixed={:.3g}%", 100 * t.relative);
}

/// From what was asked for to next to nothing.
/// chosen: in this order steps cost least of the picture (docs/measurements.md#tolerance-fraction, "Steps of tune"):
/// tolerances up to four times what hides, then edges, then light points, whose light is another one; four steps of
/// each.
std::vector<Setting> ladder_of(const RenderJob& film) {
    const int samples = film.rendering.samples, vpls = film.rendering.vpls;
    std::vector<Setting> rungs;
    const auto add = [&](float factor, int fewer_samples, int fewer_points) {
        Setting rung{"", {}, factor > 1 ? with_tolerance(film, loosened(film.tolerance, factor)) : film};
        renderer::Settings& r = rung.film.rendering;
        r.samples = std::max(1, samples / fewer_samples);
        // Rays bring their light without points.
        if (r.indirect == renderer::Indirect::lightcuts && vpls > 0)
            r.vpls = std::max(std::min(vpls, 64), vpls / fewer_points);
        if (r.samples != samples) r.edge_samples = r.most_samples = 0;
        if (factor > 1)
            rung.choices.emplace_back(
                rung.film.tolerance.coupled && !rung.film.tolerance.fraction ? "--loss" : "--tolerance",
                text_of(rung.film.tolerance));
        if (r.samples != samples) rung.choices.emplace_back("--samples", std::to_string(r.samples));
        if (r.vpls != vpls) rung.choices.emplace_back("--vpls", std::to_string(r.vpls));
        for (const auto& [name, value] : rung.choices)
            rung.name += (rung.name.empty() ? "" : ", ") + name.substr(2) + " " + value;
        if (rung.name.empty()) rung.name = "as asked for";
        if (rungs.empty() || rung.choices != rungs.back().choices) rungs.push_back(std::move(rung));
    };
    add(1, 1, 1);
    add(2, 1, 1);
    add(4, 1, 1);
    add(4, 4, 1);
    add(4, 4, 4);
    add(8, 16, 16);
    return rungs;
}

/// Takes the cheapest of those that look alike (cheapest_alike) and are done in time; else the fastest.
std::size_t rung_to_take(const Tuning& tuning) {
    const auto psnr = [&](const Probe& probe) { return probe.trial.film_quality().psnr_y; };
    const auto in_time = [&](const Probe& probe) { return probe.value <= tuning.target.value; };
    double best = -1;
    for (const Probe& probe : tuning.probes)
        if (in_time(probe)) best = std::max(best, psnr(probe));
    std::vector<Offer> offers;
    for (const Probe& probe : tuning.probes)
        offers.push_back({probe.value, best < 0 || (in_time(probe) && psnr(probe) >= best - near_psnr)});
    return *cheapest_alike(offers);
}

}  // namespace

std::string figure_text(Target::Kind kind, double value) {
    if (!std::isfinite(value)) return "-";
    using enum Target::Kind;
    if (kind == psnr) return value >= same ? "the same" : fmt::format("{:.2f} dB PSNR-Y", value);
    if (kind == ssim) return fmt::format("{:.4f} SSIM", value);
    if (kind == bitrate) return fmt::format("{:.{}f} kb/s", 1e-3 * value, value < 1e5 ? 1 : 0);
    return kind == size ? size_text(value) : clock_text(value);
}

std::string target_text(const Target& target) {
    const char* whose = target.worst_tenth ? " of the worst tenth" : "";
    if (target.kind == Target::Kind::psnr) return fmt::format("{:g} dB PSNR-Y{}", target.value, whose);
    if (target.kind == Target::Kind::ssim) return fmt::format("{:g} SSIM{}", target.value, whose);
    return figure_text(target.kind, target.value);
}

double value_of(const Target& target, const Trial& trial) {
    const Quality quality = trial.film_quality();
    if (target.kind == Target::Kind::psnr) return std::min(quality.psnr_y, same);
    return target.kind == Target::Kind::ssim ? quality.ssim_y : trial.bit_rate;
}

double even_figure(const Target& target, double value) {
    if (target.kind == Target::Kind::psnr) return std::min(value, same);
    if (target.kind == Target::Kind::ssim) return -10 * std::log10(std::max(1 - value, 1e-9));
    return std::log(std::max(value, 1.0));
}

double even_slope(const Target& target) {
    // fit: bench/fits/coupled-share.jsonl: between quantisers 2 and 16 a doubling, 20 of quality, costs 3.7 to 4.7 dB
    // and 0.35 to 0.43 of the bits.
    return target.is_rate() ? 0.025 : 0.2;
}

bool is_lossless(const Target& target, double value) {
    // chosen: what rounding leaves of an SSIM of 1.
    return target.kind == Target::Kind::psnr ? value >= same : target.kind == Target::Kind::ssim && value > 1 - 1e-9;
}

bool is_near(const Target& target, double value, double share) {
    if (target.kind == Target::Kind::psnr) return std::abs(value - target.value) <= share * near_psnr;
    if (target.kind == Target::Kind::ssim) return std::abs(value - target.value) <= share * near_ssim;
    return std::abs(value / target.value - 1) <= share * near_rate;
}

void tune_coding(Trials& trials, const Target& target, bool quiet, Tuning& tuning, const LogProbe& log) {
    CodingTuner(trials, target, quiet, tuning, log).settle();
}

void tune_time(Trials& trials, const RenderJob& film, double once, bool quiet, Tuning& tuning, const LogProbe& log) {
    const std::vector<Setting> rungs = ladder_of(film);
    bool stopped = false;
    const auto fits = [&](std::size_t index) {
        const auto tried = run_trial(trials, rungs[index], quiet);
        stopped = !tried;
        if (stopped) return false;
        const double seconds = once + tried->trial.clock * static_cast<double>(film.frame_count());
        tuning.probes.push_back({*tried, seconds, true});
        log(tuning.probes.back());
        return seconds <= tuning.target.value;
    };
    std::size_t slow = 0, fast = rungs.size() - 1;
    if (!fits(slow) && !stopped && fast > 0 && fits(fast))
        while (fast - slow > 1 && !stopped) {
            const std::size_t middle = (slow + fast) / 2;
            (fits(middle) ? fast : slow) = middle;
        }
    if (stopped) return;
    tuning.chosen = rung_to_take(tuning);
    tuning.options = tuning.probes[*tuning.chosen].choices;
    tuning.found = tuning.probes[*tuning.chosen].value <= tuning.target.value ? Found::near : Found::beyond;
}

}  // namespace render2mpeg::app
