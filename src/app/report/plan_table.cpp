#include "app/report/plan_table.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

json read_statistics(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw core::Error("reading", file.string(), "the file cannot be opened");
    try {
        json statistics = json::parse(stream);
        statistics.at("passes").get<json::object_t>();
        statistics.at("seconds").at("cpu").get<double>();
        return statistics;
    } catch (const json::exception&) {
        throw core::Error("reading", file.string(), "these are not the statistics of a render (docs/json.md)");
    }
}

/// What sample frames cost, as the statistics of a render say it.
json sample_statistics(const RenderJob& film, const FrameSample& sample) {
    json passes = json::object();
    for (const renderer::PlanRow& row : film.plan.rows())
        passes[row.name] = sample.statistics.pass_seconds[static_cast<std::size_t>(row.pass)];
    return {{"passes", passes},
            {"seconds", {{"cpu", sample.cpu}, {"tolerate", sample.statistics.stage_seconds(Stage::tolerate)}}}};
}

/// CPU seconds of a row; 0 where it has none of its own.
double seconds_of(const json& statistics, const std::string& row) {
    const auto number = [](const json& object, const std::string& key) {
        const auto found = object.find(key);
        return found != object.end() && found->is_number() ? found->get<double>() : 0.0;
    };
    if (!statistics.is_object()) return 0;
    // The film's own passes are told by stage; the renderer knows nothing of them.
    const json &seconds = statistics.at("seconds"), audit = statistics.value("audit", json());
    if (row == "first pass") return number(seconds, "first_pass");
    // The rough look of a preview is part of the rows that light it.
    if (row == "preview") return 0;
    if (row == "load" || row == "tolerate") return number(seconds, row);
    if (row == "audit") return audit.is_object() ? number(audit, "seconds") : 0.0;
    return number(statistics.at("passes"), row);
}

struct Row {
    std::string name;
    bool runs;
    std::string reason;
};

Row first_pass_row(const RenderJob& film) {
    if (film.kind != OutputKind::film) return {"first pass", false, "nobody reads it: nothing is coded"};
    if (film.two_passes) return {"first pass", true, "a bit rate is to be shared out among the pictures"};
    const bool asked = film.coding.rate_control.bit_rate > 0;
    return {"first pass", false, asked ? "not wanted: --passes 1" : "no cause: no bit rate is asked for"};
}

/// Whether light is kept on surfaces.
Row records_row(const RenderJob& film) {
    return {"records", film.cache.keeps(), film.cache.reason};
}

/// The passes in the order of their work: the film's own, and the renderer's.
std::vector<Row> rows_of(const RenderJob& film) {
    const bool coupled = film.tolerance.coupled && film.kind == OutputKind::film;
    const bool measured = film.measures_exposure;
    std::vector<Row> rows{{"load", true, measured ? "scene, textures, exposure" : "scene, textures"},
                          {"exposure", measured,
                           measured ? "none is given: a few small frames tell it; its time is in `load`"
                                    : fmt::format("no cause: {:g} EV are given", film.exposure.value_or(0))},
                          first_pass_row(film)};
    for (const renderer::PlanRow& row : film.plan.rows()) {
        if (row.pass == renderer::Pass::shade) {
            rows.push_back(records_row(film));
            rows.push_back({"preview", coupled,
                            coupled ? "first frames of chunks and shots follow no picture that tells tolerances"
                                    : "no cause: the tolerance is not coupled to coding"});
            rows.push_back({"tolerate", coupled,
                            coupled ? "what coding and the eye hide is what light may be off by"
                                    : "no cause: the tolerance is not coupled to coding"});
        }
        const bool views = row.pass == renderer::Pass::develop && film.view.name != core::ViewName::neutral;
        rows.push_back({row.name, row.runs, row.reason + (views ? "; view " + core::text_of(film.view) : "")});
        if (row.pass == renderer::Pass::shade)
            rows.push_back(
                {"audit", film.audit > 0, film.audit > 0 ? "--audit asks for it" : "nobody reads it: no --audit"});
    }
    return rows;
}

}  // namespace

json plan_of(const RenderJob& film, const json& statistics) {
    json plan = json::array();
    for (const Row& row : rows_of(film)) {
        const double seconds = seconds_of(statistics, row.name);
        plan.push_back({{"pass", row.name},
                        {"runs", row.runs},
                        {"reason", row.reason},
                        {"seconds", seconds > 0 ? json(seconds) : json(nullptr)}});
    }
    return plan;
}

std::string plan_table(const RenderJob& film, const std::filesystem::path& file, const FrameSample* sample) {
    const json statistics = !file.empty()       ? read_statistics(file)
                            : sample != nullptr ? sample_statistics(film, *sample)
                                                : json();
    const double total = statistics.is_object() ? statistics.at("seconds").at("cpu").get<double>() : 0.0;
    std::string text;
    for (const Row& row : rows_of(film)) {
        text += fmt::format("{:<3} {:<21}", row.runs ? "yes" : "no", row.name);
        const double seconds = seconds_of(statistics, row.name);
        if (seconds > 0)
            text += fmt::format(" {:>9.2f} s {:>5.1f} %", seconds, 100 * core::divide_or(seconds, total, 0.0));
        else if (statistics.is_object())
            text += std::string(20, ' ');
        text += fmt::format("  {}\n", row.reason);
    }
    if (total > 0)
        text += fmt::format("    {:<21} {:>9.2f} s {:>5.1f} %\n", file.empty() ? "these sample frames" : "whole run",
                            total, 100.0);
    return text;
}

}  // namespace render2mpeg::app
