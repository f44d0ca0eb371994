#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "app/work_folder.h"

namespace render2mpeg::app {

/// Refuses a file that could not be made because of what is there: its name or one of its folders' is taken by
/// something else, or the folder may not be written. Writes nothing.
void check_reachable(const std::filesystem::path& file);

/// Refuses what would only fail after hours of work: a file that cannot be created. Makes its folder.
void check_writable(const std::filesystem::path& file);

/// Refuses where a file to write is one of the inputs or another output: it would take its place. Names both. Empty
/// paths are passed over.
void check_apart(const std::vector<std::filesystem::path>& inputs, const std::vector<std::filesystem::path>& outputs);

/// Puts the film together, proves that it decodes to what was encoded, and only then gives it its name. Returns its
/// size in bytes.
std::uint64_t publish(const std::vector<ChunkFile>& chunks, const Film& film, WorkFolder& work,
                      const std::filesystem::path& target);

/// Gives a finished file its name, in place of what has it. Returns its size in bytes. Throws core::Error.
std::uint64_t give_name(const std::filesystem::path& file, const std::filesystem::path& target);

/// Removes what an interrupted run may have left of a film that is whole now, and its work folder.
void clear_away(const std::filesystem::path& output, WorkFolder& work);

}  // namespace render2mpeg::app
