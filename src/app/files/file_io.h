#pragma once
// Writes small files whole or not at all.
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/checksum.h"
#include "core/picture.h"

namespace render2mpeg::app {

/// Writes a file atomically, or into a pipe or device. Removes temporary files of killed runs. Throws core::Error.
void write_whole(const std::filesystem::path& file, const std::string& text);

/// All of a file. Throws core::Error.
std::string file_text(const std::filesystem::path& file);

/// JSON as lines of text; invalid UTF-8 is replaced.
std::string json_text(const nlohmann::json& value);

/// JSON that this program wrote; `discarded` (nlohmann) where it is none, or nested deeper than 32 levels, as nothing
/// of ours is.
nlohmann::json parsed_json(std::string_view text);
/// The same of a file; `discarded`, too, where it cannot be read.
nlohmann::json read_json(const std::filesystem::path& file);

void write_json(const std::filesystem::path& file, const nlohmann::json& value);

/// JSON has neither infinities nor NaN. Null, too, where there is no value.
nlohmann::json finite_or_null(std::optional<double> value);
/// Null where it is empty.
nlohmann::json text_or_null(const std::string& text);
/// The value, or null where there is none.
template <class Value>
nlohmann::json or_null(const std::optional<Value>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
}

/// Prints safe lines (core::printable) to standard output. Throws core::Error.
void print(const std::string& text);

/// Waits until a file is on the disk. Throws core::Error where it cannot be; unsupported file systems are no failure.
void bring_to_disk(const std::filesystem::path& file);

void bring_name_to_disk(const std::filesystem::path& file);

/// Whether something has this name, or a plain file; false where that cannot be told.
bool is_there(const std::filesystem::path& name);
bool is_file(const std::filesystem::path& name);

/// Absolute name with links followed; the file may be missing.
std::filesystem::path canonical_of(const std::filesystem::path& file);

using core::Checksum;
using core::checksum_of;

std::uint64_t checksum_of(const core::Picture& picture);

/// Version of this program, and checksum of its build.
std::string program_text();

/// 16 hexadecimal digits.
std::string text_of(std::uint64_t checksum);

}  // namespace render2mpeg::app
