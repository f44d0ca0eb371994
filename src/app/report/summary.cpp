#include "app/report/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "app/report/figures.h"
#include "app/system/progress.h"
#include "core/text.h"
#include "encoder/cadence.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// A line of at most 67 characters; its label is empty where it goes on.
struct SummaryLine {
    std::string label, text;
};
using SummaryLines = std::vector<SummaryLine>;

/// Share of counts as per cent.
std::string percent_of(std::uint64_t part, std::uint64_t whole) {
    return percent_text(ratio_of(part, whole));
}
std::string count_of(std::uint64_t count) {
    return count_text(static_cast<double>(count));
}

/// The shape that the film is shown in, where it is not that of square pixels.
std::string shape_text(const encoder::Settings& coding) {
    static constexpr std::array shapes{"", "", " (4:3)", " (16:9)", " (2.21:1)"};
    if (coding.aspect_ratio_code > 0) return shapes.at(static_cast<std::size_t>(coding.aspect_ratio_code));
    return " (pixels of " + core::text_of(coding.pixel_aspect) + ")";
}

std::string rate_text(const encoder::Settings& coding) {
    const std::string rate = std::string(coding.rate.name) + " Hz";
    if (coding.cadence != encoder::Cadence::pulldown) return rate;
    return rate + " (" + encoder::declared_rate(coding).name + " with repeated fields)";
}

/// Seconds by name, as lines that fit a terminal of 80 columns.
struct Seconds {
    std::string name;
    double seconds;
};
void add_seconds(SummaryLines& lines, const std::string& label, const std::vector<Seconds>& parts) {
    lines.push_back({label, ""});
    for (const Seconds& part : parts) {
        const std::string text = fmt::format("{} {:.2f}  ", part.name, part.seconds);
        if (lines.back().text.size() + text.size() > 67) lines.push_back({"", ""});
        lines.back().text += text;
    }
}

void add_time(SummaryLines& lines, const RunStatistics& statistics) {
    std::vector<Seconds> stages;
    for (std::size_t i = 0; i < statistics.seconds.size(); ++i) {
        std::string stage = stage_names[i];
        std::ranges::replace(stage, '_', ' ');
        if (statistics.seconds[i] > 0) stages.push_back({stage, statistics.seconds[i]});
    }
    add_seconds(lines, "CPU time", stages);
    lines.push_back(
        {"", fmt::format("{:.2f} s in all; {} on the clock; peak memory {:.0f} MiB",
                         statistics.earlier_cpu + cpu_seconds(), clock_text(statistics.wall), peak_memory_mib())});
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
    return cause;
}

void add_rate(SummaryLines& lines, const Film& film, const RunStatistics& statistics) {
    const auto wanted = static_cast<double>(film.coding.rate_control.bit_rate);
    if (wanted <= 0) return;
    const RateOutcome rate = statistics.rate_outcome();
    const double seconds = static_cast<double>(statistics.frames.size()) / film.coding.rate.hertz.value();
    const double real = ratio_of(8 * rate.bytes, seconds);
    lines.push_back({"rate", fmt::format("{:.0f} of {:.0f} kb/s wanted ({:+.1f} %)", 1e-3 * real, 1e-3 * wanted,
                                         100.0 * (real / wanted - 1.0))});
    if (rate.stuffing > 0) lines.back().text += ", " + percent_of(rate.stuffing, rate.bytes) + " of it stuffing";
    if (const std::string cause = rate_cause(statistics, real, wanted); !cause.empty()) lines.push_back({"", cause});
}

/// The quantisers, where they were not one number that the user gave, and what the buffer did to them.
void add_quantisers(SummaryLines& lines, const Film& film, const RunStatistics& statistics) {
    const RateOutcome rate = statistics.rate_outcome();
    const std::string scale(encoder::facts_of(film.coding.codec).scale);
    const QuantiserRange range = statistics.quantisers();
    const bool asked = film.coding.rate_control.mode == encoder::RateMode::constant_quantiser;
    if (!asked)
        lines.push_back(
            {scale, fmt::format("{:.1f} on average, pictures from {} to {}", range.mean, range.min, range.max)});
    const auto were = [](int count) { return count == 1 ? " was" : " were"; };
    if (rate.off_plan > 0)
        lines.push_back({asked ? scale : "",
                         pictures_text(rate.off_plan) + were(rate.off_plan) + " coded with another than made for"});
    if (rate.requantised > 0)
        lines.push_back({"buffer", pictures_text(rate.requantised) + were(rate.requantised) +
                                       " coded again, coarser, to reach the decoder in time"});
    if (rate.minimal > 0)
        lines.push_back({"", fmt::format("{} of them {} no detail at all: the rate is too low", rate.minimal,
                                         rate.minimal == 1 ? "shows" : "show")});
}

/// Results of a coded film. `made`: processing of its pictures before coding.
void add_coding(SummaryLines& lines, const Film& film, const RunStatistics& statistics, const RunFacts& facts,
                const char* made) {
    add_rate(lines, film, statistics);
    add_quantisers(lines, film, statistics);
    lines.push_back({"quality", fmt::format("decoded against {}: PSNR-Y {:.2f} dB, SSIM-Y {:.4f}", made,
                                            statistics.psnr_y(), statistics.ssim_y())});
    if (statistics.pumping()) lines.back().text += fmt::format(", pumping {:.2f}", *statistics.pumping());
    if (facts.loudness)
        lines.push_back({"sound", fmt::format("{:.1f} LUFS, true peak {:.1f} dB", facts.loudness->integrated,
                                              facts.loudness->true_peak)});
    const GrainBits& grain = statistics.grain;
    if (grain.pictures > 0)
        lines.push_back({"grain", fmt::format("{:.0f} bytes a picture, {} of the bits of the first {:.0f}",
                                              (grain.with - grain.without) / (8 * grain.pictures),
                                              percent_text(1 - ratio_of(grain.without, grain.with)), grain.pictures)});
}

/// Work of gathering light, or of path tracing alone.
void add_light(SummaryLines& lines, const RunStatistics& statistics) {
    const renderer::Statistics& r = statistics.rendering;
    const auto also = [&](const std::string& text) { lines.push_back({"", text}); };
    if (r.true_pixels > 0) {
        lines.push_back({"light", fmt::format("{} paths, {} a pixel", count_of(r.true_paths),
                                              count_of(r.true_paths / r.true_pixels))});
        if (r.capped_pixels > 0)
            also(percent_of(r.capped_pixels, r.true_pixels) +
                 " of the pixels stopped at the most paths, their error not reached");
    } else {
        lines.push_back(
            {"light", fmt::format("{} direct and {} indirect light points; mean cut {:.1f} and {:.1f}", r.direct_points,
                                  r.indirect_points, statistics.mean_direct_cut(), statistics.mean_indirect_cut())});
        also(fmt::format("{} points to light, {} shadow rays, {} gather rays", count_of(r.gather_points),
                         count_of(r.shadow_rays), count_of(r.gather_rays)));
    }
    if (r.capped_points > 0)
        also(percent_of(r.capped_points, r.gather_points) +
             " of the points stopped at the largest cut, their tolerance not certified");
    if (r.clamped_energy > 0.0005) also(percent_text(r.clamped_energy) + " of the light was clamped near light points");
    if (const double lost = ratio_of(r.photon_energy_lost, r.photon_energy); lost > 0.0005)
        also(percent_text(lost) +
             " of the photons' light ended on surfaces too bright to be real: none reflects over 99 %");
    if (statistics.brightest_luma <= 16) also("every pixel is black: no light reaches what the camera sees");
    if (r.non_finite > 0)
        also(fmt::format("{} value{} not finite and became 0, the first in {}", r.non_finite,
                         r.non_finite == 1 ? " was" : "s were", r.first_non_finite));
    for (const std::string& note : r.image_notes) also(core::printable(note));
}

/// Reuse of gathered light for other pixels and frames.
void add_records(SummaryLines& lines, const renderer::Statistics& r) {
    lines.push_back(
        {"records", fmt::format("{} made, at most {} held; they lit {} of the points", count_of(r.cache.created),
                                count_of(r.cache.most), percent_of(r.cache.served, r.gather_points))});
}

void add_audit(SummaryLines& lines, const Audit& audit) {
    using renderer::ErrorMeasure;
    lines.push_back({"audit", fmt::format("{:.2f} % of {} pixels, gathered again by reference light, are",
                                          100 * audit.share_over(), audit.errors.count())});
    lines.push_back(
        {"", fmt::format("beyond their tolerance; errors {:.2f} % (median), {:.2f} % (95 %), {:.2f} % (99 %)",
                         100 * audit.errors.quantile(0.5), 100 * audit.errors.quantile(0.95),
                         100 * audit.errors.quantile(0.99))});
    lines.push_back({"", fmt::format("with 95 % confidence at most {:.3g} % of the film's pixels are beyond it",
                                     100 * audit.most_over())});
    if (audit.split.pixels() == 0) return;
    lines.push_back({"truth", fmt::format("{:<13}{:>6}{:>6}{:>7}{:>17}{:>17}", "errors, paths", "luma", "8x8", "rms %",
                                          "too bright %", "darker half %")});
    constexpr std::array<const char*, renderer::cause_count> names{"gathering", "light points", "eye samples",
                                                                   "in all"};
    for (std::size_t c = 0; c < renderer::cause_count; ++c) {
        const auto cause = static_cast<renderer::ErrorCause>(c);
        const renderer::MeanError bias = audit.split.bias(cause), dark = audit.split.dark_bias(cause);
        const std::string blocks =
            audit.split.sums().blocks > 0 ? fmt::format("{:.2f}", audit.split.block_rms(cause)) : "-";
        lines.push_back({"", fmt::format("{:<13}{:>6.2f}{:>6}{:>7.2f}{:>9.2f} +- {:<4.2f}{:>9.2f} +- {:<4.2f}",
                                         names.at(c), audit.split.rms(cause, ErrorMeasure::code_value), blocks,
                                         100 * audit.split.rms(cause, ErrorMeasure::relative), 100 * bias.value,
                                         100 * bias.error, 100 * dark.value, 100 * dark.error)});
    }
    if (audit.split.sums().followed == 0) return;
    lines.push_back({"flicker", fmt::format("errors change by {:.2f} luma between frames along motion, {:.2f} of it by",
                                            audit.split.flicker(renderer::ErrorCause::total),
                                            audit.split.flicker(renderer::ErrorCause::gathering))});
    lines.push_back({"", fmt::format("gathering (rms of {} points that both show)", audit.split.sums().followed)});
}

void add_light_loss(SummaryLines& lines, const RenderJob& film, const LightLossFound& found) {
    if (found.pictures == 0) return;
    lines.push_back({"loss", fmt::format("{:.2f} dB of PSNR-Y in I and P pictures by the noise of light", found.loss)});
    if (!film.tolerance.fraction) lines.back().text += fmt::format(" ({:g} asked for)", film.tolerance.loss);
    lines.back().text += fmt::format(", which was {:.2f} of what coding hides", found.share);
}

/// "film.mpg: 60 frames, 640x360 at 25 Hz, 2.40 s, 1.2 MB, 4000 kb/s"
std::string film_line(const Film& film, const RunStatistics& statistics, const RunFacts& facts) {
    const std::size_t frames = statistics.frames.size();
    const double duration = static_cast<double>(frames) / film.coding.rate.hertz.value();
    std::string text =
        fmt::format("{}: {}, {}x{}{} at {}, {:.2f} s", core::printable(facts.output), core::counted(frames, "frame"),
                    film.coding.width, film.coding.height, shape_text(film.coding), rate_text(film.coding), duration);
    if (facts.bytes > 0)
        text += fmt::format(", {}, {:.0f} kb/s", size_text(static_cast<double>(facts.bytes)),
                            8e-3 * ratio_of(facts.bytes, duration));
    return text;
}

std::string text_of(const std::string& first, const SummaryLines& lines) {
    std::string text = first + "\n";
    for (const SummaryLine& line : lines) text += fmt::format("  {:<10} {}\n", line.label, line.text);
    return text;
}

}  // namespace

std::string summary(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts) {
    SummaryLines lines;
    add_time(lines, statistics);
    if (film.preview)
        lines.push_back({"draft", "light is rough: timing, framing and cuts are the film's (docs/pictures.md)"});
    add_light(lines, statistics);
    if (kept_records(film.rendering, statistics.rendering)) add_records(lines, statistics.rendering);
    std::vector<Seconds> effects;
    for (const Effect& e : effects_of(film, statistics))
        if (e.seconds && *e.seconds >= 0.005) effects.push_back({e.name, *e.seconds});
    add_seconds(lines, "effects", effects);
    if (film.audit > 0) add_audit(lines, statistics.audit);
    add_light_loss(lines, film, statistics.light_loss());
    if (film.kind == OutputKind::film) add_coding(lines, film.film(), statistics, facts, "rendered");
    return text_of(film_line(film.film(), statistics, facts), lines);
}

std::string encode_summary(const Film& film, const RunStatistics& statistics, const RunFacts& facts) {
    SummaryLines lines;
    add_time(lines, statistics);
    if (const std::uint64_t count = statistics.rendering.non_finite; count > 0)
        lines.push_back(
            {"frames", fmt::format("{} value{} not finite and became 0", count, count == 1 ? " was" : "s were")});
    add_coding(lines, film, statistics, facts, "the frames given");
    return text_of(film_line(film, statistics, facts), lines);
}

}  // namespace render2mpeg::app
