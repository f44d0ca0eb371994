#include "app/production/outputs.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "app/files/publish.h"
#include "app/loop/film_identity.h"
#include "app/options/output_kind.h"
#include "app/report/heatmap_film.h"
#include "app/report/report.h"
#include "core/text.h"

namespace render2mpeg::app {

bool is_one_file(const RenderJob& film) {
    return film.kind == OutputKind::film || film.kind == OutputKind::y4m;
}

void check_before_reading(const RenderOptions& options) {
    const OutputKind kind = kind_of(options.output);
    Wishes wishes;
    if (kind == OutputKind::film || kind == OutputKind::y4m) wishes.films.emplace_back(options.output);
    for (const auto& [subject, file] : options.heatmaps) wishes.films.emplace_back(file);
    for (const Files& film : wishes.films) check_reachable(film.name);
    for (const auto& file : {options.stats, options.report, options.last_frame})
        if (file) check_reachable(*file);
    if (options.report) check_report(*options.report);
    // Where reading is quick, it is first seen whether an output is an input, too.
    const bool is_slow = core::ending_of(options.input) == ".blend";
    if (is_slow && !options.dry_run && !options.resume) require_consent(wishes, options.overwrite);
}

void check_outputs(const RenderJob& film, const RenderOptions& options) {
    std::vector<Files> outputs{is_one_file(film) ? Files(options.output) : Files(options.output, film.frames),
                               options.stats.value_or(""), options.last_frame.value_or("")};
    for (const auto& [subject, file] : options.heatmaps) outputs.emplace_back(file);
    if (options.report) {
        outputs.emplace_back(*options.report);
        outputs.emplace_back(report_json_of(*options.report));
    }
    if (options.layers)
        for (const auto& pattern : {layers_in(*options.layers), motion_in(*options.layers)})
            outputs.emplace_back(pattern, film.frames);
    check_apart(inputs_of(film, options), outputs);
    for (const Files& output : outputs)
        if (!output.name.empty()) check_reachable(output.name);
    if (options.report) check_report(*options.report);
    check_heatmaps(options, film);
    WorkFolder::check(options.output);
}

Wishes written_by(const RenderJob& film, const RenderOptions& options) {
    Wishes wishes;
    wishes.films.push_back(is_one_file(film) ? Files(options.output) : Files(options.output, film.frames));
    for (const auto& [subject, file] : options.heatmaps) wishes.films.emplace_back(file);
    for (const auto& file : {options.stats, options.report}) wishes.beside.push_back(file.value_or(""));
    // This folder is made, but not those that it is in.
    const std::filesystem::path layers = options.layers.value_or("");
    wishes.beside.push_back(layers.has_filename() ? layers : layers.parent_path());
    return wishes;
}

std::unique_ptr<WorkFolder> open_outputs(const RenderOptions& options, const nlohmann::json& identity) {
    check_writable(options.output);
    if (options.layers) check_writable(layers_in(*options.layers));
    if (options.stats) check_writable(*options.stats);
    if (options.report) check_writable(*options.report);
    if (options.report) check_writable(report_json_of(*options.report));
    for (const auto& [subject, file] : options.heatmaps) check_writable(file);
    const auto earlier = options.resume ? WorkFolder::Earlier::resumed : WorkFolder::Earlier::removed;
    return std::make_unique<WorkFolder>(options.output, identity, earlier);
}

}  // namespace render2mpeg::app
