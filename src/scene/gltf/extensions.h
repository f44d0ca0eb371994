#pragma once
// Extensions of glTF: those supported, and the effect of others missing from a picture.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace render2mpeg::scene::gltf {

/// Whether an extension is read.
bool is_read(const std::string& extension);

/// Extensions of all objects, sorted.
std::vector<std::string> extensions_in(const nlohmann::json& file);

/// Note on an ignored extension and its effect.
std::string not_read(const std::string& extension);

}  // namespace render2mpeg::scene::gltf
