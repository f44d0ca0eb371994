#pragma once
// Options of commands that try a film.
#include <array>
#include <string_view>

#include "app/options/coding_options.h"

namespace render2mpeg::app {

CLI::App* add_cost_command(CLI::App& app, CostOptions& options);
CLI::App* add_compare_command(CLI::App& app, CompareOptions& options);

CLI::App* add_tune_command(CLI::App& app, TuneOptions& options);

CLI::App* add_encode_command(CLI::App& app, EncodeOptions& options);
CLI::App* add_info_command(CLI::App& app, InfoOptions& options);

/// Schedulers of `farm --to`.
inline constexpr std::array<std::string_view, 7> scheduler_names{"slurm",  "parallel",  "sge",     "kubernetes",
                                                                 "openjd", "snakemake", "flamenco"};

/// Options of `farm`'s spreading.
void add_spreading_options(CLI::App& command, FarmOptions& options);
CLI::App* add_part_command(CLI::App& app, PartOptions& options);
CLI::App* add_join_command(CLI::App& app, JoinOptions& options);
CLI::App* add_farm_status_command(CLI::App& app, FarmStatusOptions& options);

/// Words of the `render` that a `farm` stands for.
std::vector<std::string> render_words(const std::vector<std::string>& farm);

/// "A-B" as in OpenJD's chunks. Throws core::Error.
FrameRange contiguous_from(const std::string& text);

}  // namespace render2mpeg::app
