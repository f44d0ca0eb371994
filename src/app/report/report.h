#pragma once
// The page of `--report` and its JSON file.
#include <filesystem>
#include <string>

#include "app/report/statistics.h"

namespace render2mpeg::app {

/// The JSON file that a report has beside it: `film.html` has `film.report.json`.
std::filesystem::path report_json_of(const std::filesystem::path& html);

/// Throws core::Error for a name that does not end in .html, and where one of the two files would replace one that is
/// no earlier report.
void check_report(const std::filesystem::path& html);

/// A page of a report: its title, what is told first, and the rest as HTML.
std::string report_page(const std::string& title, const std::string& lead, const std::string& body);

/// Writes a render's report as one HTML page that needs nothing else, and report_json_of() it (docs/first-film.md).
/// `views`: figures of frames, as HTML.
void write_report(const std::filesystem::path& html, const RenderJob& film, const RunStatistics& statistics,
                  const RunFacts& facts, const std::string& views);

}  // namespace render2mpeg::app
