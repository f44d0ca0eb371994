#include "app/report/statistics.h"

#include <sys/resource.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/files/file_io.h"
#include "app/report/effects.h"
#include "core/numeric.h"
#include "encoder/codec.h"
#include "encoder/encoder.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

json seconds_of(const RunStatistics& statistics) {
    json seconds;
    for (std::size_t i = 0; i < statistics.seconds.size(); ++i) seconds[stage_names[i]] = statistics.seconds[i];
    seconds["wall"] = statistics.wall;
    seconds["cpu"] = statistics.earlier_cpu + cpu_seconds();
    seconds["busy_cores"] = core::divide_or(cpu_seconds(), statistics.wall - statistics.earlier_wall, 0.0);
    return seconds;
}

json passes_of(const RenderJob& film, const RunStatistics& statistics) {
    json passes = json::object();
    for (const renderer::PlanRow& row : film.plan.rows()) {
        const double seconds = statistics.pass_seconds[static_cast<std::size_t>(row.pass)];
        if (row.runs && seconds > 0) passes[row.name] = seconds;
    }
    return passes;
}

json effects_json(const RenderJob& film, const RunStatistics& statistics) {
    json all = json::array();
    const auto or_null = [](const auto& value) { return value ? json(*value) : json(nullptr); };
    for (const Effect& e : effects_of(film, statistics))
        all.push_back({{"effect", e.name},
                       {"seconds", or_null(e.seconds)},
                       {"rays", or_null(e.rays)},
                       {"clusters", or_null(e.clusters)},
                       {"note", e.note}});
    return all;
}

/// Errors against the truth, by cause.
json truth_of(const renderer::ErrorSplit& split) {
    json truth{
        {"paths", core::divide_or(static_cast<double>(split.sums().paths), static_cast<double>(split.pixels()), 0.0)},
        {"blocks", split.sums().blocks},
        {"followed", split.sums().followed}};
    const auto with_error = [](renderer::MeanError m) { return json{{"value", m.value}, {"error", m.error}}; };
    constexpr std::array measures{"", "relative_", "code_value_"};
    for (std::size_t c = 0; c < renderer::cause_count; ++c) {
        const auto cause = static_cast<renderer::ErrorCause>(c);
        json& of_cause = truth[renderer::cause_names[c]];
        of_cause = {{"bias", with_error(split.bias(cause))}, {"dark_bias", with_error(split.dark_bias(cause))}};
        if (split.sums().blocks > 0)
            of_cause.update({{"block_rms", split.block_rms(cause)},
                             {"block_mean_square", with_error(split.block_mean_square(cause))}});
        if (split.sums().followed > 0)
            of_cause.update({{"flicker_rms", split.flicker(cause)},
                             {"flicker_mean_square", with_error(split.flicker_mean_square(cause))}});
        for (std::size_t m = 0; m < renderer::measure_count; ++m) {
            const auto measure = static_cast<renderer::ErrorMeasure>(m);
            of_cause[measures.at(m) + std::string("rms")] = split.rms(cause, measure);
            of_cause[measures.at(m) + std::string("mean_square")] = with_error(split.mean_square(cause, measure));
        }
    }
    return truth;
}

json audit_of(const RenderJob& film, const Audit& audit) {
    if (film.audit == 0) return nullptr;
    return {{"pixels", audit.errors.count()},
            {"over_tolerance", audit.share_over()},
            {"error_p50", finite_or_null(audit.errors.quantile(0.5))},
            {"error_p95", finite_or_null(audit.errors.quantile(0.95))},
            {"error_p99", finite_or_null(audit.errors.quantile(0.99))},
            {"truth", truth_of(audit.split)},
            {"seconds", audit.seconds}};
}

/// The entry's members, with null for unknown values.
json entry_of(const FrameEntry& frame) {
    json entry = json_of(frame);
    entry["type"] = std::string(1, frame.type);
    if (frame.pumping < 0) entry["pumping"] = nullptr;
    return entry;
}

/// Requested, declared and actual rate of the film.
json rate_of(const Film& film, const RunStatistics& statistics) {
    constexpr const char* modes[] = {"quantiser", "quality", "variable", "constant"};
    const encoder::RateControl& asked = film.coding.rate_control;
    const encoder::Declaration declared = encoder::declaration_of(film.coding);
    const RateOutcome outcome = statistics.rate_outcome();
    json rate{{"mode", modes[static_cast<int>(asked.mode)]}, {"off_plan", outcome.off_plan}};
    if (film.coding.codec == encoder::Codec::mpeg2)
        rate.update({{"level", declared.level},
                     {"max_rate", declared.bit_rate},
                     {"vbv_bits", declared.buffer_bits},
                     {"chunk_fullness", declared.chunk_fullness},
                     {"requantised", outcome.requantised},
                     {"minimal", outcome.minimal},
                     {"stuffing", outcome.stuffing}});
    const double seconds = static_cast<double>(statistics.frames.size()) / film.coding.rate.hertz.value();
    rate["average"] = core::divide_or(8.0 * static_cast<double>(outcome.bytes), seconds, 0.0);
    if (asked.bit_rate > 0) rate["bit_rate"] = asked.bit_rate;
    if (asked.mode == encoder::RateMode::constant_quality) rate["quality"] = asked.quality;
    return rate;
}

/// The quantiser that was asked for; null where a quality or a rate decided.
json asked_quantiser(const encoder::Settings& coding) {
    return coding.rate_control.mode == encoder::RateMode::constant_quantiser ? json(coding.quantiser) : json(nullptr);
}

json quantisers_of(const RunStatistics& statistics) {
    const QuantiserRange range = statistics.quantisers();
    return {{"mean", range.mean}, {"min", range.min}, {"max", range.max}};
}

/// Tolerance of a pixel's light.
json tolerance_of(const RenderJob& film) {
    if (film.tolerance.truth) return {{"mode", "truth"}, {"relative", *film.tolerance.truth}};
    if (film.tolerance.reference) return {{"mode", "reference"}};
    if (!film.tolerance.coupled) return {{"mode", "fixed"}, {"relative", film.tolerance.relative}};
    return {{"mode", "coupled"},
            {"fraction", film.tolerance.fraction ? json(*film.tolerance.fraction) : json(nullptr)},
            {"masking", film.coupling.strategy == perceptual::Strategy::quantised ? "quantised" : "warped"}};
}

/// Statistics common to all runs. Quality counts where the film was coded.
json common_of(const Film& film, const RunStatistics& statistics, const RunFacts& facts) {
    const encoder::Settings& coding = film.coding;
    json frames = json::array();
    for (const FrameEntry& frame : statistics.frames) frames.push_back(entry_of(frame));
    return {{"version", RENDER2MPEG_VERSION},
            {"command", facts.command},
            {"input", facts.input},
            {"output", facts.output},
            {"complete", facts.complete},
            {"width", coding.width},
            {"height", coding.height},
            {"fps", coding.rate.hertz.value()},
            {"aspect_ratio_code", coding.aspect_ratio_code},
            {"cadence", coding.cadence == encoder::Cadence::frames   ? "frames"
                        : coding.cadence == encoder::Cadence::fields ? "fields"
                                                                     : "pulldown"},
            {"fps_exact", {coding.rate.hertz.num, coding.rate.hertz.den}},
            {"frames", statistics.frames.size()},
            {"bytes", facts.bytes},
            {"codec", encoder::facts_of(coding.codec).word},
            {"quantiser", asked_quantiser(coding)},
            {"gop", coding.gop},
            {"seconds", seconds_of(statistics)},
            {"peak_rss_mib", peak_memory_mib()},
            {"counts", json_of(statistics.rendering)},
            {"psnr_y", finite_or_null(statistics.psnr_y())},
            {"ssim_y", statistics.ssim_y()},
            {"pumping", statistics.pumping() ? json(*statistics.pumping()) : json(nullptr)},
            {"per_frame", frames}};
}

json glare_of(const RenderJob& film) {
    const core::Glare& glare = film.animation->glare;
    if (!glare.shows()) return {};
    return {{"kind", core::glare_names[static_cast<std::size_t>(glare.kind)]},
            {"strength", glare.strength},
            {"size", glare.size},
            {"seed", glare.seed}};
}

json fog_of(const RenderJob& film) {
    const core::Fog& fog = film.animation->fog;
    if (!fog.shows()) return {};
    return {{"visibility", fog.visibility}, {"color", {fog.color.x, fog.color.y, fog.color.z}},
            {"anisotropy", fog.anisotropy}, {"height", fog.height},
            {"falloff", fog.falloff},       {"bounces", fog.bounces}};
}

}  // namespace

double peak_memory_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

json statistics_of(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts) {
    const bool coded = film.kind == OutputKind::film;
    json written = common_of(film.film(), statistics, facts);
    written.update({
        {"exposure", film.exposure.value_or(0)},
        {"view", core::text_of(film.view)},
        {"glare", glare_of(film)},
        {"fog", fog_of(film)},
        {"isa", core::name_of(film.rendering.isa)},
        {"preview", film.preview},
        {"tolerance", tolerance_of(film)},
        {"passes", passes_of(film, statistics)},
        {"effects", effects_json(film, statistics)},
        {"mean_cut", {{"direct", statistics.mean_direct_cut()}, {"indirect", statistics.mean_indirect_cut()}}},
        {"image_notes", statistics.rendering.image_notes},
        {"audit", audit_of(film, statistics.audit)},
    });
    if (coded) written["rate"] = rate_of(film.film(), statistics);
    written["quantisers"] = coded ? quantisers_of(statistics) : json(nullptr);
    if (!coded)
        for (const char* key : {"psnr_y", "ssim_y", "pumping", "quantiser", "gop"}) written[key] = nullptr;
    return written;
}

void write_statistics(const std::filesystem::path& file, const RenderJob& film, const RunStatistics& statistics,
                      const RunFacts& facts) {
    write_json(file, statistics_of(film, statistics, facts));
}

void write_encode_statistics(const std::filesystem::path& file, const Film& film, bool with_motion,
                             const RunStatistics& statistics, const RunFacts& facts) {
    json written = common_of(film, statistics, facts);
    written["motion"] = with_motion;
    written["quantisers"] = quantisers_of(statistics);
    written["rate"] = rate_of(film, statistics);
    write_json(file, written);
}

}  // namespace render2mpeg::app
