#pragma once
// Gives a finished file its name, without replacing what is not ours.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/files/work_folder.h"
#include "app/options/film.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// A file, or the files of a numbered sequence. An empty name is passed over.
struct Files {
    Files(std::filesystem::path file) : name(std::move(file)) {}
    Files(std::filesystem::path pattern, FrameRange numbers) : name(std::move(pattern)), frames(numbers) {}

    std::filesystem::path name;        ///< with frames: a pattern
    std::optional<FrameRange> frames;  ///< none: one file
};

/// Refuses a file that could not be made because of what is there: its name or one of its folders' is taken by
/// something else, or the file or the folder may not be written. Writes nothing.
void check_reachable(const std::filesystem::path& file);

/// Refuses what would only fail after hours of work: a file that cannot be created. Makes its folder.
void check_writable(const std::filesystem::path& file);

/// Refuses where a file to write is one of the inputs or another output: it would take its place. Names both.
void check_apart(const std::vector<Files>& inputs, const std::vector<Files>& outputs);

/// A file under its name for good.
struct Published {
    std::filesystem::path name;
    std::uint64_t bytes = 0;
};

/// Puts the film together, proves that it decodes to what was encoded, and only then gives it its name. The work folder
/// stays as it is, for whoever needs it still. Where the film is not complete, what there is gets a name that nobody
/// has (WorkFolder::leave). A pipe or a device of that name is written to and stays. Throws core::Error.
Published publish(const std::vector<ChunkFile>& chunks, const Film& film, WorkFolder& work,
                  const std::filesystem::path& output, bool complete);

/// The same for a file of the work folder that is put together already.
Published give_name(const std::filesystem::path& file, WorkFolder& work, const std::filesystem::path& output,
                    bool complete);

}  // namespace render2mpeg::app
