#pragma once
// The statistics file of `--stats`.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"

namespace render2mpeg::app {

/// Further facts for the statistics file of a run.
struct RunFacts {
    std::string command;
    std::string input, output;
    std::uint64_t bytes = 0;  ///< of the output file; 0 for image sequences
    bool complete = true;     ///< false: interrupted
};

/// Largest resident memory of this process so far, MiB.
double peak_memory_mib();

/// Contents of the file of write_statistics().
nlohmann::json statistics_of(const RenderJob& film, const RunStatistics& statistics, const RunFacts& facts);

/// Writes the statistics file (docs/json.md).
void write_statistics(const std::filesystem::path& file, const RenderJob& film, const RunStatistics& statistics,
                      const RunFacts& facts);

/// The same for a film of frames from outside; `with_motion`: vectors were given.
void write_encode_statistics(const std::filesystem::path& file, const Film& film, bool with_motion,
                             const RunStatistics& statistics, const RunFacts& facts);

}  // namespace render2mpeg::app
