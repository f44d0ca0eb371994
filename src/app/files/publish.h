#pragma once
// Gives a finished file its name, without replacing files that are not ours.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/files/work_folder.h"
#include "app/options/film.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// Joins chunks to a film in the format of `name`'s ending. Returns how loud its sound is; none: silent.
std::optional<av::Loudness> assemble(std::span<const ChunkFile> chunks, const Film& film,
                                     const std::filesystem::path& file, const std::filesystem::path& name);

/// A file, or the files of a numbered sequence. An empty name is passed over.
struct Files {
    Files(std::filesystem::path file) : name(std::move(file)) {}
    Files(std::filesystem::path pattern, FrameRange numbers) : name(std::move(pattern)), frames(numbers) {}

    std::filesystem::path name;        ///< with frames: a pattern
    std::optional<FrameRange> frames;  ///< none: one file
};

/// Refuses a file whose name or folder is taken or protected. Writes nothing.
void check_reachable(const std::filesystem::path& file);

/// Refuses a file that cannot be created. Makes its folder.
void check_writable(const std::filesystem::path& file);

/// Refuses outputs that are an input or another output; names both.
void check_apart(const std::vector<Files>& inputs, const std::vector<Files>& outputs);

struct Published {
    std::filesystem::path name;
    std::uint64_t bytes = 0;
    std::optional<av::Loudness> loudness = {};  ///< none: silent
};

/// Assembles and verifies the film, then renames it; an incomplete one stays in the work folder. Pipes and devices are
/// written to. Throws core::Error.
Published publish(std::span<const ChunkFile> chunks, const Film& film, WorkFolder& work,
                  const std::filesystem::path& output, bool complete);

/// A file that keeps its name.
Published published_at(const std::filesystem::path& file);

/// Renames an assembled file. Throws core::Error.
Published give_name(const std::filesystem::path& file, const std::filesystem::path& output);

/// Gives a file a second name; it keeps its own. Throws core::Error.
void place(const std::filesystem::path& from, const std::filesystem::path& to);

struct Wishes {
    std::vector<Files> dear;                    ///< films, frames, figures: replaced only with consent
    std::vector<std::filesystem::path> beside;  ///< pages, folders of frames; an empty name is passed over
};

/// Throws core::Error where something dear exists or a folder is missing, unless `agreed`. Empty files, pipes and
/// devices hold nothing. Writes nothing.
void require_consent(const Wishes& wishes, bool agreed);

/// All its refusals as lines, for dry runs.
std::vector<std::string> doubts_about(const Wishes& wishes);

}  // namespace render2mpeg::app
