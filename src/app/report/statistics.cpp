#include "app/report/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "app/files/file_io.h"
#include "app/system/memory_limit.h"
#include "core/numeric.h"
#include "encoder/codec.h"
#include "encoder/encoder.h"

namespace render2mpeg::app {
namespace {

using renderer::Pass;

struct Named {
    Pass pass;
    const char* name;
};

/// "lamps, shining shapes and the sky", as far as these passes run.
std::string list_of(const renderer::Plan& plan, std::initializer_list<Named> passes) {
    std::vector<std::string> names;
    for (const Named& named : passes)
        if (plan.runs(named.pass)) names.emplace_back(named.name);
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    return text;
}

}  // namespace

std::vector<Effect> effects_of(const RenderJob& film, const RunStatistics& statistics) {
    const renderer::Plan& plan = film.plan;
    const renderer::Statistics& r = statistics.rendering;
    const auto pass = [&](Pass p) { return statistics.of(p); };
    std::vector<Effect> effects;
    const double exposing = pass(Pass::shutter) + pass(Pass::lens);
    // A clock that samples may tell more than the whole it is part of.
    const double see = pass(Pass::see), sky = std::min(r.sky_seconds, see);
    effects.push_back({"seeing", see - sky, r.primary_rays, {}, ""});
    if (plan.runs(Pass::sky_background))
        effects.push_back({"the sky seen", sky, {}, {}, "about; what it lights is in direct light"});
    const std::string blur = list_of(plan, {{Pass::shutter, "open shutter"}, {Pass::lens, "lens"}});
    if (!blur.empty())
        effects.push_back({blur, exposing, r.exposure_rays, {}, "what they show of all that is blurred"});
    const std::string specular =
        list_of(plan, {{Pass::lobe_rays, "narrow lobes"}, {Pass::mirrors, "mirrors"}, {Pass::glass, "glass"}});
    if (!specular.empty())
        effects.push_back(
            {specular, {}, r.specular_rays, {}, "time in seeing, and in the light of what is seen there"});
    if (plan.runs(Pass::caustics))
        effects.push_back(
            {"caustics", pass(Pass::caustics), r.caustic_rays, {}, "light that mirrors and glass throw, by photons"});
    if (const std::string own = list_of(plan, {{Pass::hair, "hair"}, {Pass::subsurface, "subsurface"}}); !own.empty())
        effects.push_back(
            {own, pass(Pass::hair) + pass(Pass::subsurface), r.hair.rays, {}, "their light, by rays of their own"});
    // Layers are met by shadow rays to all lights alike.
    const bool photons = plan.runs(Pass::photons);
    const double direct = pass(Pass::punctual_lights) + pass(Pass::emissive_lights) + pass(Pass::direct_tree);
    const bool bounces = plan.runs(Pass::indirect_tree);
    const double bounced = bounces ? pass(Pass::indirect_tree) : 0.0;
    const double layers = std::min(r.layer_seconds, direct + bounced);
    const double rest = core::divide_or(direct + bounced - layers, direct + bounced, 1.0);
    if (const std::string sources = list_of(plan, {{Pass::punctual_lights, "lamps"},
                                                   {Pass::emissive_lights, "shining surfaces"},
                                                   {Pass::sky_light, "the sky"}});
        !sources.empty())
        effects.push_back({"direct light", rest * direct, {}, r.direct_clusters, sources});
    if (photons)
        effects.push_back({"photons", pass(Pass::photons), r.photon_rays, {}, "that carry light to where it bounces"});
    if (bounces && film.rendering.indirect == renderer::Indirect::rays)
        effects.push_back({"bounced light", rest * bounced, r.gather_rays, {}, ""});
    else if (bounces)
        effects.push_back({"bounced light", rest * bounced, {}, r.indirect_clusters, ""});
    if (plan.runs(Pass::alpha) || plan.runs(Pass::glass))
        effects.push_back({"transparent shadows", layers, {}, {}, "about: what layers let through of light"});
    if (film.tolerance.coupled && film.kind == OutputKind::film)
        effects.push_back(
            {"what the eye misses", statistics.of(Stage::tolerate), {}, {}, "tolerances from the pictures before"});
    if (plan.runs(Pass::air)) effects.push_back({"fog", pass(Pass::air), r.air_rays, {}, "light that air scatters"});
    if (plan.runs(Pass::glare)) effects.push_back({"glare", pass(Pass::glare), {}, {}, ""});
    if (plan.runs(Pass::motion)) effects.push_back({"motion", pass(Pass::motion), {}, {}, ""});
    if (film.kind == OutputKind::film) effects.push_back({"coding", statistics.of(Stage::encode), {}, {}, ""});
    return effects;
}

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
        const double seconds = statistics.of(row.pass);
        if (row.runs && seconds > 0) passes[row.name] = seconds;
    }
    return passes;
}

json effects_json(const RenderJob& film, const RunStatistics& statistics) {
    json all = json::array();
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
    json truth{{"paths", ratio_of(split.sums().paths, split.pixels())},
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
            {"over_tolerance_at_most", audit.most_over()},
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
    if (frame.cost.loss < 0) entry["light_loss"] = nullptr;
    json& stages = entry["seconds_by_stage"] = json::object();
    for (std::size_t i = 0; i < stage_names.size(); ++i)
        if (const double seconds = frame.cost.seconds_by_stage[i]; seconds > 0) stages[stage_names[i]] = seconds;
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
    rate["average"] = ratio_of(8 * outcome.bytes, seconds);
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
            {"fraction", or_null(film.tolerance.fraction)},
            {"masking", film.coupling.strategy == perceptual::Strategy::quantised ? "quantised" : "warped"}};
}

/// Loss by light: asked for, and found.
json light_loss_of(const RenderJob& film, const RunStatistics& statistics) {
    const LightLossFound found = statistics.light_loss();
    if (found.pictures == 0) return nullptr;
    return {{"asked", film.tolerance.fraction ? json(nullptr) : json(film.tolerance.loss)},
            {"pictures", found.pictures},
            {"found", found.loss},
            {"share", found.share}};
}

json grain_bits_of(const GrainBits& grain) {
    if (grain.pictures == 0) return {};
    const auto count = [](double value) { return static_cast<std::int64_t>(value); };
    return {{"pictures", count(grain.pictures)}, {"with", count(grain.with)}, {"without", count(grain.without)}};
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
            {"grain", coding.grain},
            {"grain_bits", grain_bits_of(statistics.grain)},
            {"loudness",
             facts.loudness ? json{{"integrated", facts.loudness->integrated}, {"true_peak", facts.loudness->true_peak}}
                            : json()},
            {"seconds", seconds_of(statistics)},
            {"peak_rss_mib", peak_memory_mib()},
            {"counts", json_of(statistics.rendering)},
            {"psnr_y", finite_or_null(statistics.psnr_y())},
            {"ssim_y", statistics.ssim_y()},
            {"pumping", or_null(statistics.pumping())},
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
    return static_cast<double>(own_memory().peak) / (1 << 20);
}

json statistics_of(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts) {
    const bool coded = film.kind == OutputKind::film;
    json written = common_of(film.film(), statistics, facts);
    if (statistics.light.most > 0)
        written.update({{"max_cll", statistics.light.most}, {"max_fall", statistics.light.mean}});
    written.update({
        {"exposure", film.exposure.value_or(0)},
        {"view", core::text_of(film.view)},
        {"glare", glare_of(film)},
        {"fog", fog_of(film)},
        {"isa", core::name_of(film.rendering.isa)},
        {"preview", film.preview},
        {"tolerance", tolerance_of(film)},
        {"light_loss", light_loss_of(film, statistics)},
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

namespace {

using nlohmann::json;

struct Row {
    std::string name;
    bool runs;
    std::string reason;
    std::optional<renderer::Pass> pass = {};  ///< none: the film's own
    std::optional<Stage> stage = {};          ///< whose time it takes
};

/// CPU seconds of a row; 0 where it has none of its own. The rough look of a preview is part of the rows that light it.
double seconds_of(const RunStatistics& statistics, const Row& row) {
    if (row.pass) return statistics.of(*row.pass);
    if (row.stage) return statistics.of(*row.stage);
    return row.name == "audit" ? statistics.audit.seconds : 0;
}

Row first_pass_row(const RenderJob& film) {
    const auto row = [](bool runs, const char* reason) {
        return Row{"first pass", runs, reason, {}, Stage::first_pass};
    };
    if (film.kind != OutputKind::film) return row(false, "nobody reads it: nothing is coded");
    if (film.two_passes) return row(true, "a bit rate is to be shared out among the pictures");
    const bool asked = film.coding.rate_control.bit_rate > 0;
    return row(false, asked ? "not wanted: --passes 1" : "no cause: no bit rate is asked for");
}

/// The passes in the order of their work: the film's own, and the renderer's.
std::vector<Row> rows_of(const RenderJob& film) {
    const bool coupled = film.tolerance.coupled && film.kind == OutputKind::film;
    const bool measured = film.measures_exposure;
    const std::string uncoupled = "no cause: the tolerance is not coupled to coding";
    std::vector<Row> rows{{"load", true, "scene, textures", {}, Stage::load},
                          {"exposure",
                           measured,
                           measured ? "none is given: a few small frames tell it"
                                    : fmt::format("no cause: {:g} EV are given", film.exposure.value_or(0)),
                           {},
                           Stage::exposure},
                          first_pass_row(film)};
    for (const renderer::PlanRow& row : film.plan.rows()) {
        if (row.pass == renderer::Pass::shade) {
            rows.push_back({"records", film.cache.keeps(), film.cache.reason});
            rows.push_back(
                {"preview", coupled,
                 coupled ? "first frames of chunks and shots follow no picture that tells tolerances" : uncoupled});
            rows.push_back({"tolerate",
                            coupled,
                            coupled ? "what coding and the eye hide is what light may be off by" : uncoupled,
                            {},
                            Stage::tolerate});
        }
        const bool views = row.pass == renderer::Pass::develop && film.view.name != core::ViewName::neutral;
        rows.push_back(
            {row.name, row.runs, row.reason + (views ? "; view " + core::text_of(film.view) : ""), row.pass});
        if (row.pass == renderer::Pass::shade)
            rows.push_back(
                {"audit", film.audit > 0, film.audit > 0 ? "--audit asks for it" : "nobody reads it: no --audit"});
    }
    return rows;
}

}  // namespace

json plan_of(const RenderJob& film, const RunStatistics& statistics) {
    json plan = json::array();
    for (const Row& row : rows_of(film)) {
        const double seconds = seconds_of(statistics, row);
        plan.push_back({{"pass", row.name},
                        {"runs", row.runs},
                        {"reason", row.reason},
                        {"seconds", seconds > 0 ? json(seconds) : json(nullptr)}});
    }
    return plan;
}

std::string plan_table(const RenderJob& film, const FrameSample* sample) {
    std::string text;
    for (const Row& row : rows_of(film)) {
        text += fmt::format("{:<3} {:<21}", row.runs ? "yes" : "no", row.name);
        const double seconds = sample != nullptr ? seconds_of(sample->statistics, row) : 0;
        if (seconds > 0)
            text += fmt::format(" {:>9.2f} s {:>5.1f} %", seconds, 100 * core::divide_or(seconds, sample->cpu, 0.0));
        else if (sample != nullptr)
            text += std::string(20, ' ');
        text += fmt::format("  {}\n", row.reason);
    }
    if (sample != nullptr)
        text += fmt::format("    {:<21} {:>9.2f} s {:>5.1f} %\n", "these sample frames", sample->cpu, 100.0);
    return text;
}

}  // namespace render2mpeg::app
