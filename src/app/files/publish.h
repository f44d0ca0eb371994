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

/// Joins chunks to one film `file`, whose format the ending of `name` tells.
void assemble(const std::vector<ChunkFile>& chunks, const Film& film, const std::filesystem::path& file,
              const std::filesystem::path& name);

/// Decodes the film and throws core::Error unless every picture equals its recorded reconstruction bit for bit.
void verify(const std::filesystem::path& film, const std::vector<ChunkFile>& chunks);

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

/// What a run is going to write.
struct Wishes {
    std::vector<Files> films;                   ///< what took long to make: not to be replaced without a word
    std::vector<std::filesystem::path> beside;  ///< figures, pages, folders of frames; an empty name is passed over
};

/// Throws core::Error where a film is there already or a folder is missing, unless it was `agreed`. Empty files, pipes
/// and devices are no films. Writes nothing.
void require_consent(const Wishes& wishes, bool agreed);

/// Lines about all that it would refuse; for runs that write nothing.
std::vector<std::string> doubts_about(const Wishes& wishes);

}  // namespace render2mpeg::app
