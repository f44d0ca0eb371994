#include "app/report/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "app/report/effects.h"
#include "app/report/figures.h"
#include "app/system/progress.h"
#include "core/numeric.h"
#include "core/text.h"
#include "encoder/cadence.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// The shape that the film is shown in, where it is not that of square pixels.
const char* shape_text(const encoder::Settings& coding) {
    static constexpr std::array shapes{"", "", " (4:3)", " (16:9)", " (2.21:1)"};
    return shapes.at(static_cast<std::size_t>(coding.aspect_ratio_code));
}

std::string rate_text(const encoder::Settings& coding) {
    const std::string rate = std::string(coding.rate.name) + " Hz";
    if (coding.cadence != encoder::Cadence::pulldown) return rate;
    return rate + " (" + encoder::declared_rate(coding).name + " with repeated fields)";
}

/// What making the film took, in lines that fit a terminal of 80 columns.
std::string time_lines(const RunStatistics& statistics) {
    std::string text, line = "  CPU time  ";
    for (std::size_t i = 0; i < statistics.seconds.size(); ++i) {
        if (statistics.seconds[i] <= 0) continue;
        std::string stage = stage_names[i];
        std::replace(stage.begin(), stage.end(), '_', ' ');
        const std::string part = fmt::format(" {} {:.2f} ", stage, statistics.seconds[i]);
        if (line.size() + part.size() > 80) {
            text += line + "\n";
            line = std::string(12, ' ');
        }
        line += part;
    }
    return text + line + "\n" +
           fmt::format("             {:.2f} s in all; {} on the clock; peak memory {:.0f} MiB\n",
                       statistics.earlier_cpu + cpu_seconds(), clock_text(statistics.wall), peak_memory_mib());
}

/// The film and what making it took.
std::string opening_lines(const Film& film, const RunStatistics& statistics, const RunFacts& facts) {
    const auto frames = static_cast<double>(statistics.frames.size());
    const double duration = frames / film.coding.rate.hertz.value();
    std::string text =
        fmt::format("{}: {} frame{}, {}x{}{} at {}, {:.2f} s", core::printable(facts.output), statistics.frames.size(),
                    statistics.frames.size() == 1 ? "" : "s", film.coding.width, film.coding.height,
                    shape_text(film.coding), rate_text(film.coding), duration);
    if (facts.bytes > 0)
        text += fmt::format(", {}, {:.0f} kb/s", size_text(static_cast<double>(facts.bytes)),
                            core::divide_or(8e-3 * static_cast<double>(facts.bytes), duration, 0.0));
    return text + "\n" + time_lines(statistics);
}

/// Why a film has not the rate that was wanted of it, as far as its pictures tell.
std::string rate_cause(const RunStatistics& statistics, double real, double wanted) {
    // chosen: two passes are to be within 2 %; less needs no cause.
    constexpr double close = 0.02;
    const QuantiserRange quantisers = statistics.quantisers();
    const RateOutcome rate = statistics.rate_outcome();
    std::string cause;
    if (real < (1 - close) * wanted) {
        if (quantisers.finest > 0)
            cause = pictures_text(quantisers.finest) + " at quantiser 1 need no more";
        else if (rate.requantised > 0)
            cause = pictures_text(rate.requantised) + " had to be coarser to reach the decoder in time";
    } else if (real > (1 + close) * wanted && quantisers.coarsest > 0) {
        cause = pictures_text(quantisers.coarsest) + " at quantiser 31 need that much";
    }
    return cause.empty() ? "" : "\n             " + cause;
}

std::string rate_lines(const Film& film, const RunStatistics& statistics) {
    const auto wanted = static_cast<double>(film.coding.rate_control.bit_rate);
    if (wanted <= 0) return {};
    const RateOutcome rate = statistics.rate_outcome();
    const double seconds = static_cast<double>(statistics.frames.size()) / film.coding.rate.hertz.value();
    const double real = core::divide_or(8.0 * static_cast<double>(rate.bytes), seconds, 0.0);
    std::string text = fmt::format("  rate       {:.0f} of {:.0f} kb/s wanted ({:+.1f} %)", 1e-3 * real, 1e-3 * wanted,
                                   100.0 * (real / wanted - 1.0));
    if (rate.stuffing > 0)
        text += fmt::format(", {} of it stuffing", percent_text(core::divide_or(static_cast<double>(rate.stuffing),
                                                                                static_cast<double>(rate.bytes), 0.0)));
    return text + rate_cause(statistics, real, wanted) + "\n";
}

/// The quantisers, where they were not one number that the user gave, and what the buffer did to them.
std::string quantiser_lines(const Film& film, const RunStatistics& statistics) {
    const RateOutcome rate = statistics.rate_outcome();
    const std::string_view scale = encoder::facts_of(film.coding.codec).scale;
    std::string text;
    if (film.coding.rate_control.mode != encoder::RateMode::constant_quantiser) {
        const QuantiserRange range = statistics.quantisers();
        text += range.min == range.max ? fmt::format("  {:<9}  {} in all pictures\n", scale, range.min)
                                       : fmt::format("  {:<9}  {:.1f} on average, pictures from {} to {}\n", scale,
                                                     range.mean, range.min, range.max);
    }
    const std::string_view label = text.empty() ? scale : "";
    if (rate.off_plan > 0)
        text +=
            fmt::format("  {:<9}  {} of {} {} coded with another than made for\n", label, rate.off_plan,
                        pictures_text(static_cast<int>(statistics.frames.size())), rate.off_plan == 1 ? "was" : "were");
    if (rate.requantised > 0)
        text += fmt::format("  buffer     {} {} coded again, coarser, to reach the decoder in time\n",
                            pictures_text(rate.requantised), rate.requantised == 1 ? "was" : "were");
    if (rate.minimal > 0)
        text += fmt::format("             {} of them {} no detail at all: the rate is too low\n", rate.minimal,
                            rate.minimal == 1 ? "shows" : "show");
    return text;
}

/// How a coded film came out. `made`: what was done to its pictures before they were coded.
std::string closing_lines(const Film& film, const RunStatistics& statistics, const char* made) {
    return rate_lines(film, statistics) + quantiser_lines(film, statistics) +
           fmt::format("  quality    decoded against {}: PSNR-Y {:.2f} dB, SSIM-Y {:.4f}{}\n", made,
                       statistics.psnr_y(), statistics.ssim_y(),
                       statistics.pumping() ? fmt::format(", pumping {:.2f}", *statistics.pumping()) : "");
}

/// What frames by paths alone took.
std::string truth_lines(const renderer::Statistics& r) {
    const auto pixels = static_cast<double>(r.true_pixels);
    std::string text = fmt::format("  light      {} paths, {} a pixel\n", count_text(static_cast<double>(r.true_paths)),
                                   count_text(static_cast<double>(r.true_paths) / pixels));
    if (r.capped_pixels > 0)
        text += fmt::format("             {} of the pixels stopped at the most paths, their error not reached\n",
                            percent_text(static_cast<double>(r.capped_pixels) / pixels));
    return text;
}

/// What gathering light took.
std::string light_lines(const RunStatistics& statistics) {
    const renderer::Statistics& r = statistics.rendering;
    std::string text =
        r.true_pixels > 0
            ? truth_lines(r)
            : fmt::format(
                  "  light      {} direct and {} indirect light points; mean cut {:.1f} and {:.1f}\n"
                  "             {} points to light, {} shadow rays, {} gather rays\n",
                  r.direct_points, r.indirect_points, statistics.mean_direct_cut(), statistics.mean_indirect_cut(),
                  count_text(static_cast<double>(r.gather_points)), count_text(static_cast<double>(r.shadow_rays)),
                  count_text(static_cast<double>(r.gather_rays)));
    if (r.capped_points > 0)
        text += fmt::format("             {} of the points stopped at the largest cut, their tolerance not certified\n",
                            percent_text(core::divide_or(static_cast<double>(r.capped_points),
                                                         static_cast<double>(r.gather_points), 0.0)));
    if (r.clamped_energy > 0.0005)
        text +=
            fmt::format("             {} of the light was clamped near light points\n", percent_text(r.clamped_energy));
    if (const double lost = core::divide_or(r.photon_energy_lost, r.photon_energy, 0.0); lost > 0.0005)
        text += fmt::format(
            "             {} of the photons' light ended on surfaces too bright to be real: none reflects over 99 %\n",
            percent_text(lost));
    if (statistics.brightest_luma <= 16)
        text += "             every pixel is black: no light reaches what the camera sees\n";
    if (r.non_finite > 0)
        text += fmt::format("             {} value{} not finite and became 0, the first in {}\n", r.non_finite,
                            r.non_finite == 1 ? " was" : "s were", r.first_non_finite);
    for (const std::string& note : r.image_notes) text += "             " + core::printable(note) + "\n";
    return text;
}

/// What light that was gathered once did for other pixels and frames.
std::string record_lines(const renderer::Statistics& r) {
    const double served =
        core::divide_or(static_cast<double>(r.cache.served), static_cast<double>(r.gather_points), 0.0);
    std::string text = fmt::format("  records    {} made, at most {} held; they lit {} of the points\n",
                                   count_text(static_cast<double>(r.cache.created)),
                                   count_text(static_cast<double>(r.cache.most)), percent_text(served));
    if (r.cache.held_out > 0)
        text += fmt::format("             {} of {} that were gathered all the same were off by more than allowed\n",
                            percent_text(static_cast<double>(r.cache.missed) / static_cast<double>(r.cache.held_out)),
                            count_text(static_cast<double>(r.cache.held_out)));
    return text;
}

/// Which tolerances the clusters were spent on, where there are several.
std::string band_lines(const renderer::ToleranceBands& bands) {
    const auto all =
        static_cast<double>(std::accumulate(bands.clusters.begin(), bands.clusters.end(), std::uint64_t{0}));
    std::string shares;
    int kinds = 0;
    for (std::size_t i = 0; i < bands.count; ++i) {
        const double share = 100 * core::divide_or(static_cast<double>(bands.clusters[i]), all, 0.0);
        if (share < 0.5) continue;
        const std::string low = i == 0 ? "0" : fmt::format("{:g}", 100 * bands.ends[i - 1]);
        const std::string high = i < bands.ends.size() ? fmt::format("-{:g}", 100 * bands.ends[i]) : "+";
        shares += fmt::format("{}{:.0f} % at {}{}", kinds++ == 0 ? "" : ", ", share, low, high);
    }
    return kinds < 2 ? "" : "  spent      by tolerance in %: " + shares + "\n";
}

/// What each part of the picture took, in lines that fit a terminal of 80 columns.
std::string effect_lines(const RenderJob& film, const RunStatistics& statistics) {
    std::string text, line = "  effects   ";
    for (const Effect& e : effects_of(film, statistics)) {
        if (!e.seconds || *e.seconds < 0.005) continue;
        const std::string part = fmt::format(" {} {:.2f} ", e.name, *e.seconds);
        if (line.size() + part.size() > 80) {
            text += line + "\n";
            line = std::string(12, ' ');
        }
        line += part;
    }
    return text + line + "\n";
}

/// What the film's own light taught its cuts.
std::string error_scale_lines(const renderer::Statistics& r) {
    return fmt::format(
        "  error_scale    {:.2f} ({:.2f} to {:.2f}) of what the worst films need; {} pixels,\n"
        "             lit again by reference light, said so in {:.2f} s\n",
        r.mean_error_scale, r.least_error_scale, r.largest_error_scale, r.calibrated_pixels, r.calibration_seconds);
}

std::string audit_lines(const Audit& audit) {
    using renderer::ErrorCause;
    using renderer::ErrorMeasure;
    std::string text = fmt::format(
        "  audit      {:.2f} % of {} pixels, gathered again by reference light, are\n"
        "             beyond their tolerance; errors {:.2f} % (median), {:.2f} % (95 %), {:.2f} % (99 %)\n",
        100 * audit.share_over(), audit.errors.count(), 100 * audit.errors.quantile(0.5),
        100 * audit.errors.quantile(0.95), 100 * audit.errors.quantile(0.99));
    if (audit.split.pixels() == 0) return text;
    text += fmt::format("  truth      {:<24}{:>8}{:>8}{:>16}{:>16}\n", "errors by paths of light", "luma", "rms %",
                        "too bright %", "darker half %");
    constexpr std::array names{"gathering and records", "records' places", "light points", "eye samples", "in all"};
    for (std::size_t c = 0; c < renderer::cause_count; ++c) {
        const auto cause = static_cast<ErrorCause>(c);
        const renderer::MeanError bias = audit.split.bias(cause), dark = audit.split.dark_bias(cause);
        text += fmt::format("             {:<24}{:>8.2f}{:>8.2f}{:>8.2f} +- {:<4.2f}{:>8.2f} +- {:<4.2f}\n",
                            names.at(c), audit.split.rms(cause, ErrorMeasure::code_value),
                            100 * audit.split.rms(cause, ErrorMeasure::relative), 100 * bias.value, 100 * bias.error,
                            100 * dark.value, 100 * dark.error);
    }
    return text;
}

}  // namespace

std::string summary(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts) {
    std::string text = opening_lines(film.film(), statistics, facts);
    if (film.preview)
        text += "  draft      light is rough: timing, framing and cuts are the film's (docs/pictures.md)\n";
    text += light_lines(statistics);
    if (kept_records(film.rendering, statistics.rendering)) text += record_lines(statistics.rendering);
    text += effect_lines(film, statistics) + band_lines(statistics.rendering.bands);
    if (statistics.rendering.calibrated_pixels > 0) text += error_scale_lines(statistics.rendering);
    if (film.audit > 0) text += audit_lines(statistics.audit);
    if (film.kind == OutputKind::film) text += closing_lines(film.film(), statistics, "rendered");
    return text;
}

std::string encode_summary(const Film& film, const RunStatistics& statistics, const RunFacts& facts) {
    std::string text = opening_lines(film, statistics, facts);
    if (const std::uint64_t count = statistics.rendering.non_finite; count > 0)
        text += fmt::format("  frames     {} value{} not finite and became 0\n", count, count == 1 ? " was" : "s were");
    return text + closing_lines(film, statistics, "the frames given");
}

}  // namespace render2mpeg::app
