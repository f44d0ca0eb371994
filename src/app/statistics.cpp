#include "app/statistics.h"

#include <sys/resource.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// JSON has no infinity: a lossless film has no PSNR.
json finite_or_null(double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
}

json seconds_of(const Ledger& ledger) {
    json seconds;
    for (std::size_t i = 0; i < ledger.seconds.size(); ++i) seconds[stage_names[i]] = ledger.seconds[i];
    seconds["wall"] = ledger.wall;
    seconds["cpu"] = cpu_seconds();
    return seconds;
}

json passes_of(const Production& film, const Ledger& ledger) {
    json passes = json::object();
    for (const renderer::PlanRow& row : film.plan.rows()) {
        const double seconds = ledger.pass_seconds[static_cast<std::size_t>(row.pass)];
        if (row.runs && seconds > 0) passes[row.name] = seconds;
    }
    return passes;
}

json entry_of(const FrameEntry& frame, bool coded) {
    json entry{{"frame", frame.frame},
               {"seconds", frame.seconds},
               {"shadow_rays", frame.shadow_rays},
               {"cut", {{"direct", frame.direct_cut}, {"indirect", frame.indirect_cut}}}};
    if (coded) {
        entry["type"] = std::string(1, frame.type);
        entry["quantiser"] = frame.quantiser;
        entry["bytes"] = frame.bytes;
        entry["exceeds_level"] = frame.exceeds_level;
        entry["mse_y"] = frame.mse_y;
        entry["ssim_y"] = frame.ssim_y;
    }
    return entry;
}

}  // namespace

double peak_memory_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void write_statistics(const std::filesystem::path& file, const Production& film, const Ledger& ledger,
                      const RunFacts& facts) {
    const renderer::Statistics& r = ledger.rendering;
    const bool coded = film.kind == OutputKind::film;
    json statistics{
        {"version", RENDER2MPEG_VERSION},
        {"command", facts.command},
        {"input", facts.input},
        {"output", facts.output},
        {"complete", facts.complete},
        {"width", film.format.width},
        {"height", film.format.height},
        {"fps", film.rate.hertz.value()},
        {"fps_exact", {film.rate.hertz.num, film.rate.hertz.den}},
        {"frames", ledger.frames.size()},
        {"bytes", facts.bytes},
        {"exposure", film.exposure.value_or(0)},
        {"quantiser", film.coding.quantiser},
        {"gop", film.coding.gop},
        {"isa", core::name_of(film.rendering.isa)},
        {"seconds", seconds_of(ledger)},
        {"passes", passes_of(film, ledger)},
        {"rays",
         {{"primary", r.primary_rays},
          {"specular", r.specular_rays},
          {"shadow", r.shadow_rays},
          {"photon", r.photon_rays}}},
        {"light_points", {{"direct", r.direct_points}, {"indirect", r.indirect_points}}},
        {"mean_cut", {{"direct", ledger.mean_direct_cut()}, {"indirect", ledger.mean_indirect_cut()}}},
        {"gather_points", r.gather_points},
        {"capped_points", r.capped_points},
        {"peak_rss_mib", peak_memory_mib()},
        {"non_finite", r.non_finite},
        {"first_non_finite", r.first_non_finite},
        {"clamped_energy", r.clamped_energy},
        {"psnr_y", coded ? finite_or_null(ledger.psnr_y()) : json(nullptr)},
        {"ssim_y", coded ? json(ledger.ssim_y()) : json(nullptr)},
        {"per_frame", json::array()},
    };
    for (const FrameEntry& frame : ledger.frames) statistics["per_frame"].push_back(entry_of(frame, coded));

    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream << statistics.dump(1) << "\n";
    stream.close();
    if (!stream) throw core::Error("writing", file.string(), "the file cannot be written");
}

}  // namespace render2mpeg::app
