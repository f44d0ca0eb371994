#pragma once
// Extensions of glTF: which are read, and what a picture loses where others are not.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace render2mpeg::scene::gltf {

/// Whether an extension is read.
bool is_read(const std::string& extension);

/// The names of all extensions that objects of the file carry, sorted.
std::vector<std::string> extensions_in(const nlohmann::json& file);

/// One line on an extension that is not read, and what that means for the picture.
std::string not_read(const std::string& extension);

}  // namespace render2mpeg::scene::gltf
