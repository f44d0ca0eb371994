#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace render2mpeg::scene {

/// Bytes of a `data:` URI; none for other URIs. Throws std::invalid_argument.
std::optional<std::vector<std::byte>> bytes_of_data_uri(const std::string& uri);

/// File of a relative URI [RFC3986] within `folder`; it need not exist. Throws std::invalid_argument for absolute
/// paths, other schemes, and paths or links that leave the folder.
std::filesystem::path path_of_uri(const std::string& uri, const std::filesystem::path& folder);

}  // namespace render2mpeg::scene
