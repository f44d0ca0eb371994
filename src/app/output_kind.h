#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace render2mpeg::app {

enum class OutputKind { film, y4m, exr, png };

/// What the ending of an output name asks for. Throws core::Error with the list of endings; image sequences need one
/// `%0Nd`.
OutputKind kind_of(const std::filesystem::path& output);

/// Whether a file name has the one frame number of an image sequence: `%d`, `%4d` or `%04d`.
bool is_numbered(const std::filesystem::path& pattern);

/// The frame numbers for which an image sequence has a file, ascending.
std::vector<std::int64_t> numbers_on_disk(const std::filesystem::path& pattern);

/// The name of frame n of an image sequence: its `%0Nd` (or `%d`) replaced.
std::filesystem::path numbered(const std::filesystem::path& pattern, std::int64_t frame);

/// Where unfinished work lies: `film.mpg` has `film.mpg.partial/` and, after an interruption, `film.partial.mpg`.
std::filesystem::path work_folder_of(const std::filesystem::path& output);
std::filesystem::path partial_film_of(const std::filesystem::path& output);

}  // namespace render2mpeg::app
