#pragma once
// Options of the commands that spread a film over many machines.
#include <array>
#include <string_view>

#include "app/options/coding_options.h"

namespace render2mpeg::app {

/// What `farm --to` knows.
inline constexpr std::array<std::string_view, 7> scheduler_names{"slurm",  "parallel",  "sge",     "kubernetes",
                                                                 "openjd", "snakemake", "flamenco"};

/// How a film is spread, for `farm`.
void add_spreading_options(CLI::App& command, FarmOptions& options);
CLI::App* add_part_command(CLI::App& app, PartOptions& options);
CLI::App* add_join_command(CLI::App& app, JoinOptions& options);
CLI::App* add_farm_status_command(CLI::App& app, FarmStatusOptions& options);

/// The words of the `render` that a `farm` with these words stands for: without how it is spread and run.
std::vector<std::string> render_words(const std::vector<std::string>& farm);

/// "A-B" as OpenJD writes a chunk of frames. Throws core::Error for anything else.
FrameRange contiguous_from(const std::string& text);

}  // namespace render2mpeg::app
