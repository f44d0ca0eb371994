#pragma once
// Output of `tune`: table, sentences, JSON file and page.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/experiments/tuning.h"
#include "app/loop/render_job.h"

namespace render2mpeg::app {

/// Lines of at most 80 columns, each with its end.
std::string tune_heading(const RenderJob& film, const Tuning& tuning);
std::string probe_row(const Tuning& tuning, const Probe& probe, double pictures_per_second);

/// The result in a sentence or two; empty after an interruption.
std::string sentence_of(const Tuning& tuning, double pictures_per_second);
/// The whole film beside its sample; empty where none was made.
std::string film_sentence(const Tuning& tuning);
/// The film's value in the target's unit, and whether it is near enough.
double film_value(const Tuning& tuning);
bool film_is_near(const Tuning& tuning);
/// Whether a probe's setting is to be taken: none where the target is out of reach, or the film missed it.
bool is_taken(const Tuning& tuning, std::size_t probe);
/// The --quality that comes nearer where a film missed a quality; else none.
std::optional<double> nearer_quality(const Tuning& tuning);

/// All results (docs/choosing.md).
nlohmann::json tune_json(const RenderJob& film, const Tuning& tuning, const std::string& command);

/// The same as a page with plots, and report_json_of() it.
void write_tune_report(const std::filesystem::path& html, const RenderJob& film, const Tuning& tuning,
                       const std::string& command);

}  // namespace render2mpeg::app
