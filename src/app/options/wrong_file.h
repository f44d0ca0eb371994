#pragma once
// Files that are given where another kind is meant: what they are, and which command is for them.
#include <filesystem>
#include <string>

namespace render2mpeg::app {

/// Why a file cannot be a scene, and what to do with it; empty where its ending does not say so. A folder is none
/// without a film.json; the scenes in it are named.
std::string not_a_scene(const std::filesystem::path& file);

/// The same of films that `info` reads.
std::string not_a_film(const std::filesystem::path& file);

/// What to write instead of a file with an ending that is not written.
std::string instead_of(const std::filesystem::path& output);

}  // namespace render2mpeg::app
