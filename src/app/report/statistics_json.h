#pragma once
// How statistics are written as JSON.
#include <nlohmann/json_fwd.hpp>

#include "app/report/statistics.h"

namespace render2mpeg::app {

/// JSON has neither infinity, the PSNR of a film that lost nothing, nor what is no number.
nlohmann::json finite_or_null(double value);

/// What write_statistics() writes.
nlohmann::json statistics_of(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts);

/// The plan's rows as plan_table() shows them: `pass`, `runs`, `reason`, and `seconds` (CPU) or null, as the statistics
/// of a render tell. Statistics may be null: not known.
nlohmann::json plan_of(const RenderJob& film, const nlohmann::json& statistics);

/// Writes JSON to a file. Throws core::Error.
void write_json(const std::filesystem::path& file, const nlohmann::json& value);

}  // namespace render2mpeg::app
