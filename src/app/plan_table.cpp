#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/statistics.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

/// CPU seconds by row of the table, and of the whole, from the statistics of a render.
struct PassCosts {
    nlohmann::json rows;
    double total = 0;
};

PassCosts read_costs(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw core::Error("reading", file.string(), "the file cannot be opened");
    try {
        const nlohmann::json statistics = nlohmann::json::parse(stream);
        const nlohmann::json& seconds = statistics.at("seconds");
        PassCosts costs{statistics.at("passes"), seconds.at("cpu").get<double>()};
        // Rows of the film's own, which the renderer knows nothing of.
        for (const char* stage : {"load", "preview", "tolerate"}) costs.rows[stage] = seconds.value(stage, 0.0);
        costs.rows["first pass"] = seconds.value("first_pass", 0.0);
        if (const auto audit = statistics.find("audit"); audit != statistics.end() && audit->is_object())
            costs.rows["audit"] = audit->value("seconds", 0.0);
        return costs;
    } catch (const nlohmann::json::exception&) {
        throw core::Error("reading", file.string(), "these are not the statistics of a render (docs/stats.md)");
    }
}

struct Row {
    std::string name;
    bool runs;
    std::string reason;
};

Row first_pass_row(const Production& film) {
    if (film.kind != OutputKind::film) return {"first pass", false, "nobody reads it: nothing is coded"};
    if (film.two_passes) return {"first pass", true, "a bit rate is to be shared out among the pictures"};
    const bool asked = film.coding.rate_control.bit_rate > 0;
    return {"first pass", false, asked ? "not wanted: --passes 1" : "no cause: no bit rate is asked for"};
}

/// The passes in the order of their work: the film's own, and the renderer's.
std::vector<Row> rows_of(const Production& film) {
    const bool coupled = film.tolerance.coupled && film.kind == OutputKind::film;
    std::vector<Row> rows{{"load", true, "scene, textures" + std::string(film.exposure ? "" : ", exposure")},
                          {"exposure", !film.exposure,
                           film.exposure ? fmt::format("no cause: {:g} EV are given", *film.exposure)
                                         : "none is given: a few small frames tell it; its time is in `load`"},
                          first_pass_row(film)};
    for (const renderer::PlanRow& row : film.plan.rows()) {
        if (row.pass == renderer::Pass::shade) {
            rows.push_back({"preview", coupled,
                            coupled ? "first frames of chunks and shots follow no picture that tells tolerances"
                                    : "no cause: the tolerance is not coupled to coding"});
            rows.push_back({"tolerate", coupled,
                            coupled ? "what coding and the eye hide is what light may be off by"
                                    : "no cause: the tolerance is not coupled to coding"});
        }
        rows.push_back({row.name, row.runs, row.reason});
        if (row.pass == renderer::Pass::shade)
            rows.push_back(
                {"audit", film.audit > 0, film.audit > 0 ? "--audit asks for it" : "nobody reads it: no --audit"});
    }
    return rows;
}

}  // namespace

std::string plan_table(const Production& film, const std::filesystem::path& statistics) {
    const bool costs_known = !statistics.empty();
    const PassCosts costs = costs_known ? read_costs(statistics) : PassCosts{};
    std::string text;
    for (const Row& row : rows_of(film)) {
        text += fmt::format("{:<3} {:<21}", row.runs ? "yes" : "no", row.name);
        if (costs_known) {
            const auto cost = costs.rows.find(row.name);
            const bool known = cost != costs.rows.end() && cost->is_number() && cost->get<double>() > 0;
            text += known ? fmt::format(" {:>9.2f} s {:>5.1f} %", cost->get<double>(),
                                        100 * core::divide_or(cost->get<double>(), costs.total, 0.0))
                          : fmt::format(" {:>11} {:>7}", "", "");
        }
        text += fmt::format("  {}\n", row.reason);
    }
    if (costs_known) text += fmt::format("    {:<21} {:>9.2f} s {:>5.1f} %\n", "whole run", costs.total, 100.0);
    return text;
}

}  // namespace render2mpeg::app
