#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// References from one file to another, as far as a scene may make them. [RFC3986]
namespace render2mpeg::scene {

/// The bytes of a `data:` URI (base64 or percent-encoded); nothing for other URIs. Throws std::invalid_argument with
/// the cause for a broken one.
std::optional<std::vector<std::byte>> bytes_of_data_uri(const std::string& uri);

/// The file that a relative URI names, percent-decoded, within `folder`. Throws std::invalid_argument with the cause
/// for absolute paths, other schemes, and whatever leaves the folder, symbolic links included. The file need not exist.
std::filesystem::path path_of_uri(const std::string& uri, const std::filesystem::path& folder);

}  // namespace render2mpeg::scene
