#pragma once
// Whether a name can be read as a plain file.
#include <filesystem>
#include <string>

namespace render2mpeg::core {

/// Why a name is not read: "there is no such file", or "it is a device; ..." and the like. Empty for plain files:
/// others may never end, or never begin.
std::string why_no_plain_file(const std::filesystem::path& file);

}  // namespace render2mpeg::core
