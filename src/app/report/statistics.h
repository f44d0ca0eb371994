#pragma once
// The statistics file of `--stats`.
#include <filesystem>
#include <string>

#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"

namespace render2mpeg::app {

/// What a run's statistics say besides the statistics.
struct RunFacts {
    std::string command;
    std::string input, output;
    std::uint64_t bytes = 0;  ///< of the output file; 0 for image sequences
    bool complete = true;     ///< false: interrupted
};

/// Largest resident memory of this process so far, MiB.
double peak_memory_mib();

/// Writes the statistics file (docs/stats.md).
void write_statistics(const std::filesystem::path& file, const RenderJob& film, const RunStatistics& statistics,
                      const RunFacts& facts);

/// The same for a film of frames from outside; `with_motion`: vectors were given.
void write_encode_statistics(const std::filesystem::path& file, const Film& film, bool with_motion,
                             const RunStatistics& statistics, const RunFacts& facts);

/// The lines a user reads at the end of a render, and of encoding frames from outside.
std::string encode_summary(const Film& film, const RunStatistics& statistics, const RunFacts& facts);
std::string summary(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts);

/// The plan as a table: each pass, whether it runs, why, and, if `statistics` names the file of a render, what it cost.
/// Throws core::Error where that file is none.
std::string plan_table(const RenderJob& film, const std::filesystem::path& statistics);

}  // namespace render2mpeg::app
