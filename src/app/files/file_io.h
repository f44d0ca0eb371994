#pragma once
// Writes small files whole or not at all.
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/checksum.h"
#include "core/picture.h"

namespace render2mpeg::app {

/// Writes a file that is there whole or not at all, in place of what has its name. What is no ordinary file, such as a
/// pipe, is written to. What a run that was killed left of the same file goes. Throws core::Error.
void write_whole(const std::filesystem::path& file, const std::string& text);

/// All of a file. Throws core::Error.
std::string file_text(const std::filesystem::path& file);

/// JSON as lines of text. Names of files are bytes, which JSON need not hold: what is no UTF-8 is replaced.
std::string json_text(const nlohmann::json& value);

/// JSON that a file holds; `discarded` (nlohmann) where it cannot be read.
nlohmann::json read_json(const std::filesystem::path& file);

/// Writes such text whole or not at all. Throws core::Error.
void write_json(const std::filesystem::path& file, const nlohmann::json& value);

/// JSON has neither infinity, the PSNR of a film that lost nothing, nor what is no number.
nlohmann::json finite_or_null(double value);

/// A name as it comes back out of such text.
std::string as_json_keeps(const std::string& name);

/// Writes lines of text to standard output; whatever they hold does nothing to a terminal (core::printable). Throws
/// core::Error where that fails.
void print(const std::string& text);

/// Waits until a file's bytes are on the disk, so that nothing that is written later survives them when the power
/// fails. Throws core::Error where they cannot be kept; that a file system knows no such thing is no failure.
void bring_to_disk(const std::filesystem::path& file);

/// Likewise for the names in the folder that `file` is in.
void bring_name_to_disk(const std::filesystem::path& file);

/// A file's full name with all links followed, whether it is there or not.
std::filesystem::path canonical_of(const std::filesystem::path& file);

using core::Checksum;
using core::checksum_of;

/// Of a picture's three planes.
std::uint64_t checksum_of(const core::Picture& picture);

/// Of this program: two builds that differ have two. Empty where it cannot be read.
std::string build_identity();

/// 16 hexadecimal digits.
std::string text_of(std::uint64_t checksum);

}  // namespace render2mpeg::app
