#pragma once
// The page of `--report` and its JSON file.
#include <filesystem>

#include "app/report/statistics.h"

namespace render2mpeg::app {

/// The JSON file that a report has beside it: `film.html` has `film.report.json`.
std::filesystem::path report_json_of(const std::filesystem::path& html);

/// Throws core::Error for a name that does not end in .html, and where one of the two files would replace one that is
/// no earlier report.
void check_report(const std::filesystem::path& html);

/// Writes a page that needs nothing else (page.html): its `kind`, `title`, `lead`, `figures` as in the JSON file, and
/// what that kind shows besides. `part`: of HTML, at its end.
void write_page(const std::filesystem::path& html, const nlohmann::json& page, const std::string& part = {});

/// Writes a render's page, and report_json_of() it (docs/first-film.md). `pictures`: of sample frames (frame_view.h).
void write_report(const std::filesystem::path& html, const RenderJob& film, const RunStatistics& statistics,
                  const RunFacts& facts, const nlohmann::json& pictures);

}  // namespace render2mpeg::app
