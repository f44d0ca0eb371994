#pragma once
// The statistics file of `--stats`.
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/estimate/forecast.h"
#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"

namespace render2mpeg::app {

/// Cost of one visible effect of a film.
struct Effect {
    std::string name;                       ///< "bounced light"
    std::optional<double> seconds;          ///< CPU; none: it is part of another's
    std::optional<std::uint64_t> rays;      ///< of its own kind; shadow rays are direct and bounced light's together
    std::optional<std::uint64_t> clusters;  ///< of lights that were gathered
    std::string note;                       ///< its components, or where its time is counted; may be empty
};

/// Components of the film's light and pictures with their costs, in the order of their making. Effects absent from the
/// film are left out.
std::vector<Effect> effects_of(const RenderJob& film, const RunStatistics& statistics);

/// Further facts for the statistics file of a run.
struct RunFacts {
    std::string command;
    std::string input, output;
    std::uint64_t bytes = 0;                    ///< of the output file; 0 for image sequences
    bool complete = true;                       ///< false: interrupted
    std::optional<av::Loudness> loudness = {};  ///< of the film's sound; none: silent, or a stream
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

/// The plan as a table: each pass, whether it runs, why, and its cost in sample frames; null: none were lit.
std::string plan_table(const RenderJob& film, const FrameSample* sample = nullptr);

/// The plan's rows: `pass`, `runs`, `reason`, and `seconds` (CPU) or null.
nlohmann::json plan_of(const RenderJob& film, const RunStatistics& statistics);

}  // namespace render2mpeg::app
