#pragma once
// What the ending of an output's name asks for.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace render2mpeg::app {

enum class OutputKind { film, y4m, exr, png };

/// What the ending of an output name asks for. Throws core::Error with the list of endings; image sequences need one
/// `%0Nd`.
OutputKind kind_of(const std::filesystem::path& output);

/// What is written to standard output instead of a file: where `output` is `-`, it becomes a name whose ending says
/// what `as` says (.ts where that says nothing), and `as` is set. Throws UsageError where `as` has no use.
void settle_stream(std::filesystem::path& output, std::optional<std::string>& as);

/// Throws UsageError where a film would be written to a terminal.
void check_pipe(int descriptor);

/// What messages call standard output.
inline constexpr const char* stream_name = "standard output";

/// Whether a file name has the one frame number of an image sequence: `%d`, `%4d` or `%04d`.
bool is_numbered(const std::filesystem::path& pattern);

/// The frame numbers for which an image sequence has a file, ascending.
std::vector<std::int64_t> numbers_on_disk(const std::filesystem::path& pattern);

/// The name of frame n of an image sequence: its `%0Nd` (or `%d`) replaced.
std::filesystem::path numbered(const std::filesystem::path& pattern, std::int64_t frame);

/// The number in the name of a file of an image sequence; none where the name is none that numbered() would give.
std::optional<std::int64_t> number_in(const std::filesystem::path& pattern, const std::filesystem::path& file);

/// The image sequence that --aov writes into a folder.
std::filesystem::path layers_in(const std::filesystem::path& folder);
/// The same of the motion beside them, in a form of its own (docs/coding.md).
std::filesystem::path motion_in(const std::filesystem::path& folder);

/// Where unfinished work lies: `film.mpg` has `film.mpg.partial/` and, after an interruption, `film.partial.mpg`, or
/// `film.partial-2.mpg` and so on.
std::filesystem::path work_folder_of(const std::filesystem::path& output);
std::filesystem::path partial_film_of(const std::filesystem::path& output, int which = 1);

/// Bytes that the pictures of a film may have so that a file of `bytes` with so many of them is surely large enough,
/// by what its container, which its ending names, takes for itself (more for a DVD's `disc`); at least 1.
double pictures_in_file(double bytes, std::int64_t pictures, const std::filesystem::path& file, bool disc);

/// Bytes of the file that so many pictures of `bytes` make, about.
double file_of_pictures(double bytes, std::int64_t pictures, const std::filesystem::path& file, bool disc);

}  // namespace render2mpeg::app
