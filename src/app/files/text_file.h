#pragma once
// Writes small files whole or not at all.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace render2mpeg::app {

/// Writes a file that is there whole or not at all, in place of what has its name. What is no ordinary file, such as a
/// pipe, is written to. What a run that was killed left of the same file goes. Throws core::Error.
void write_whole(const std::filesystem::path& file, const std::string& text);

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

}  // namespace render2mpeg::app
