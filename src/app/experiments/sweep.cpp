#include "app/experiments/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "app/experiments/knee.h"

namespace render2mpeg::app {
namespace {

/// chosen: a span of PSNR-Y that nobody sees, and times that are not told apart: there is no knee within them.
constexpr double least_range = 0.5, least_times = 1.1;

/// Where advice begins when there is no knee: the tolerance that frames are lit with unless asked otherwise.
std::size_t usual(const Sweep& sweep) {
    const auto nearest = std::min_element(sweep.fixed.begin(), sweep.fixed.end(), [](const Trial& a, const Trial& b) {
        const auto distance = [](const Trial& t) { return std::abs(std::log(t.tolerance.relative / 0.02f)); };
        return distance(a) < distance(b);
    });
    return static_cast<std::size_t>(nearest - sweep.fixed.begin());
}

/// "0.12 dB of PSNR-Y", "nothing of PSNR-Y" below what two digits show.
std::string gain_text(double difference) {
    return difference < 0.005 ? "nothing of PSNR-Y" : fmt::format("{:.2f} dB of PSNR-Y", difference);
}

std::string seconds_text(double seconds) {
    return short_figure(seconds) + " s";
}

bool differs(const Trial& t) {
    return std::isfinite(t.decoded.psnr_y());
}

std::string tighter_text(const Trial& here, const Trial& next) {
    return fmt::format("the next step tighter, {}, takes {:.2f} times its time ({} a frame instead of {}) and buys {}",
                       tolerance_text(next.tolerance.relative), next.seconds / here.seconds, seconds_text(next.seconds),
                       seconds_text(here.seconds), gain_text(next.decoded.psnr_y() - here.decoded.psnr_y()));
}

std::string looser_text(const Trial& here, const Trial& next) {
    const std::string saving = next.seconds < here.seconds ? fmt::format("would save {:.0f} % of its time",
                                                                         100 * (1 - next.seconds / here.seconds))
                                                           : std::string("would save no time");
    return fmt::format("the next looser, {}, {} and lose {}", tolerance_text(next.tolerance.relative), saving,
                       gain_text(here.decoded.psnr_y() - next.decoded.psnr_y()));
}

/// Why there is no knee.
std::string no_knee_text(const Sweep& sweep) {
    if (sweep.fixed.size() < 3 || !std::all_of(sweep.fixed.begin(), sweep.fixed.end(), differs)) return {};
    const Trial &loosest = sweep.fixed.front(), &tightest = sweep.fixed.back();
    double best = 0;
    for (const Trial& t : sweep.fixed) best = std::max(best, t.decoded.psnr_y() - loosest.decoded.psnr_y());
    if (best >= least_range) return "No knee: no step buys much less than the one before. ";
    return fmt::format("No knee: from {} to {} the decoded film gains {}. ", tolerance_text(loosest.tolerance.relative),
                       tolerance_text(tightest.tolerance.relative), gain_text(best));
}

std::string steps_sentence(const Sweep& sweep, int quantiser) {
    if (std::all_of(sweep.fixed.begin(), sweep.fixed.end(), [](const Trial& t) { return t.points == 0; }))
        return "Nothing in these frames gathers light: tolerances cost no time and change nothing. ";
    // The sentence is about one row and those beside it.
    const std::optional<std::size_t> knee = knee_of(sweep);
    const std::size_t i = knee.value_or(usual(sweep));
    const auto first = sweep.fixed.begin() + static_cast<std::ptrdiff_t>(i - std::min<std::size_t>(i, 1));
    const auto end = sweep.fixed.begin() + static_cast<std::ptrdiff_t>(std::min(i + 2, sweep.fixed.size()));
    if (!std::all_of(first, end, differs))
        return fmt::format("Decoded, some of these tolerances cannot be told from reference light at quantiser {}. ",
                           quantiser);
    if (!std::all_of(first, end, [](const Trial& t) { return t.seconds > 0; }))
        return "Some of these tolerances take too little time to be measured. ";
    if (sweep.fixed.size() < 2) return {};
    const Trial& here = sweep.fixed[i];
    std::string text = knee ? "" : no_knee_text(sweep);
    text += fmt::format("{} {} at quantiser {}", knee ? "The knee is at" : "From",
                        tolerance_text(here.tolerance.relative), quantiser);
    if (i + 1 < sweep.fixed.size()) text += (knee ? ": " : ", ") + tighter_text(here, sweep.fixed[i + 1]);
    if (i > 0) text += (i + 1 < sweep.fixed.size() ? "; " : knee ? ": " : ", ") + looser_text(here, sweep.fixed[i - 1]);
    return text + ". ";
}

std::string coupled_sentence(const CoupledPair& pair) {
    const std::optional<double> ratio = pair.time_ratio(), loss = pair.psnr_loss();
    if (!ratio) return {};
    std::string text = fmt::format("Coupled to quantiser {}, light takes {:.2f} times that of a fixed 2 %",
                                   pair.coupled.quantiser, *ratio);
    if (!loss) return text + ".";
    if (std::abs(*loss) < 0.005) return text + ", at the same PSNR-Y.";
    text += fmt::format(" and {} {:.2f} dB of PSNR-Y", *loss < 0 ? "wins" : "loses", std::abs(*loss));
    return text + ".";
}

}  // namespace

std::optional<double> CoupledPair::time_ratio() const {
    if (!(coupled.seconds > 0 && fixed.seconds > 0) || fixed.points == 0) return std::nullopt;
    return coupled.seconds / fixed.seconds;
}

std::optional<double> CoupledPair::psnr_loss() const {
    const double loss = fixed.decoded.psnr_y() - coupled.decoded.psnr_y();
    return std::isfinite(loss) ? std::optional(loss) : std::nullopt;
}

std::optional<std::size_t> knee_of(const Sweep& sweep) {
    std::vector<Offer> offers;
    for (const Trial& t : sweep.fixed) offers.push_back({t.points > 0 ? t.cpu : 0.0, t.decoded.psnr_y()});
    const auto [least, most] = std::minmax_element(offers.begin(), offers.end(),
                                                   [](const Offer& a, const Offer& b) { return a.cost < b.cost; });
    if (!offers.empty() && most->cost <= least_times * least->cost) return {};
    return knee_of(offers, least_range);
}

std::string sentence_of(const Sweep& sweep, int quantiser) {
    std::string text = sweep.fixed.empty() ? "" : steps_sentence(sweep, quantiser);
    const auto nearest =
        std::min_element(sweep.pairs.begin(), sweep.pairs.end(), [&](const CoupledPair& a, const CoupledPair& b) {
            return std::abs(a.coupled.quantiser - quantiser) < std::abs(b.coupled.quantiser - quantiser);
        });
    if (nearest != sweep.pairs.end()) text += coupled_sentence(*nearest);
    while (text.ends_with(' ')) text.pop_back();
    return text;
}

std::string tolerance_text(float share) {
    return fmt::format("{:.4g} %", 100 * share);
}

std::string short_figure(double value) {
    if (!std::isfinite(value)) return "-";
    if (value >= 999.5) return fmt::format("{:.0f}", value);
    if (value < 0.0005) return "0";
    const int digits = value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
    return fmt::format("{:.{}f}", value, value < 0.095 ? 3 : digits);
}

}  // namespace render2mpeg::app
