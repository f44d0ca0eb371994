#pragma once
// The summary that a render prints.
#include <string>
#include <vector>

#include "app/report/statistics.h"

namespace render2mpeg::app {

/// A line of at most 67 characters; its label is empty where it goes on.
struct SummaryLine {
    std::string label, text;
};
using SummaryLines = std::vector<SummaryLine>;
SummaryLines summary_lines(const RenderJob& film, const RunStatistics& statistics);

/// The lines a user reads at the end of a render, and of encoding frames from outside.
std::string summary(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts);
std::string encode_summary(const Film& film, const RunStatistics& statistics, const RunFacts& facts);

}  // namespace render2mpeg::app
