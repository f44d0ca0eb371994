#include "app/report/plan_table.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

struct Row {
    std::string name;
    bool runs;
    std::string reason;
    std::optional<renderer::Pass> pass;  ///< none: the film's own
};

/// CPU seconds of a row; 0 where it has none of its own. The rough look of a preview is part of the rows that light it.
double seconds_of(const RunStatistics& statistics, const Row& row) {
    if (row.pass) return statistics.pass_seconds[static_cast<std::size_t>(*row.pass)];
    if (row.name == "first pass") return statistics.stage_seconds(Stage::first_pass);
    if (row.name == "load") return statistics.stage_seconds(Stage::load);
    if (row.name == "exposure") return statistics.stage_seconds(Stage::exposure);
    if (row.name == "tolerate") return statistics.stage_seconds(Stage::tolerate);
    return row.name == "audit" ? statistics.audit.seconds : 0;
}

Row first_pass_row(const RenderJob& film) {
    if (film.kind != OutputKind::film) return {"first pass", false, "nobody reads it: nothing is coded", {}};
    if (film.two_passes) return {"first pass", true, "a bit rate is to be shared out among the pictures", {}};
    const bool asked = film.coding.rate_control.bit_rate > 0;
    return {"first pass", false, asked ? "not wanted: --passes 1" : "no cause: no bit rate is asked for", {}};
}

/// Whether light is kept on surfaces.
Row records_row(const RenderJob& film) {
    return {"records", film.cache.keeps(), film.cache.reason, {}};
}

/// The passes in the order of their work: the film's own, and the renderer's.
std::vector<Row> rows_of(const RenderJob& film) {
    const bool coupled = film.tolerance.coupled && film.kind == OutputKind::film;
    const bool measured = film.measures_exposure;
    std::vector<Row> rows{{"load", true, "scene, textures", {}},
                          {"exposure",
                           measured,
                           measured ? "none is given: a few small frames tell it"
                                    : fmt::format("no cause: {:g} EV are given", film.exposure.value_or(0)),
                           {}},
                          first_pass_row(film)};
    for (const renderer::PlanRow& row : film.plan.rows()) {
        if (row.pass == renderer::Pass::shade) {
            rows.push_back(records_row(film));
            rows.push_back({"preview",
                            coupled,
                            coupled ? "first frames of chunks and shots follow no picture that tells tolerances"
                                    : "no cause: the tolerance is not coupled to coding",
                            {}});
            rows.push_back({"tolerate",
                            coupled,
                            coupled ? "what coding and the eye hide is what light may be off by"
                                    : "no cause: the tolerance is not coupled to coding",
                            {}});
        }
        const bool views = row.pass == renderer::Pass::develop && film.view.name != core::ViewName::neutral;
        rows.push_back(
            {row.name, row.runs, row.reason + (views ? "; view " + core::text_of(film.view) : ""), row.pass});
        if (row.pass == renderer::Pass::shade)
            rows.push_back(
                {"audit", film.audit > 0, film.audit > 0 ? "--audit asks for it" : "nobody reads it: no --audit", {}});
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
