#pragma once
// Output of `tune`: table, sentences, JSON file and page.
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/experiments/trial_table.h"
#include "app/experiments/tuning.h"

namespace render2mpeg::app {

/// Lines of at most 80 columns, each with its end.
std::string probe_heads(const Target& target);
std::string probe_row(const Target& target, const Probe& probe);

/// The result in a sentence or two; empty after an interruption.
std::string sentence_of(const Tuning& tuning);
/// The whole film beside its sample; empty where none was made.
std::string film_sentence(const Tuning& tuning);
/// The film's value in the target's unit, and whether it is near enough.
double film_value(const Tuning& tuning);
bool film_is_near(const Tuning& tuning);
/// The --quality that comes nearer where a film missed a quality; else none.
std::optional<double> nearer_quality(const Tuning& tuning);

/// All results (docs/json.md), and what a page shows besides.
nlohmann::json tune_json(const Tuning& tuning);
nlohmann::json tune_page(const RenderJob& film, const Tuning& tuning);

}  // namespace render2mpeg::app
