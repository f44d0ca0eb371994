#pragma once
// Kinds of output by name.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace render2mpeg::app {

enum class OutputKind { film, y4m, exr, png };

/// Whether it is made in a work folder, and is no sequence of images.
inline bool is_one_file(OutputKind kind) {
    return kind == OutputKind::film || kind == OutputKind::y4m;
}

/// Kind of output by ending. Throws core::Error with the list of endings; image sequences need one `%0Nd`.
OutputKind kind_of(const std::filesystem::path& output);

/// Replaces `-` by a name with the ending of `as` (default .ts). Throws UsageError for an unused `as`.
void settle_stream(std::filesystem::path& output, std::optional<std::string>& as);

/// Throws UsageError for a terminal.
void check_pipe(int descriptor);

inline constexpr const char* stream_name = "standard output";

/// Whether a name has one frame number: `%d`, `%4d` or `%04d`.
bool is_numbered(const std::filesystem::path& pattern);

std::vector<std::int64_t> numbers_on_disk(const std::filesystem::path& pattern);

std::filesystem::path numbered(const std::filesystem::path& pattern, std::int64_t frame);

/// Frame number of a file; none unless numbered() gives this name.
std::optional<std::int64_t> number_in(const std::filesystem::path& pattern, const std::filesystem::path& file);

/// Image sequence of --aov in a folder.
std::filesystem::path layers_in(const std::filesystem::path& folder);
/// Its motion files (docs/coding.md).
std::filesystem::path motion_in(const std::filesystem::path& folder);

/// `film.mpg.partial/`
std::filesystem::path work_folder_of(const std::filesystem::path& output);

}  // namespace render2mpeg::app
