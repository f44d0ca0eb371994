#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace render2mpeg::bench {

/// The textures that the benchmark's films use, each 1024x1024, without a seam, with detail down to about four texels:
/// an encoder that is only shown smooth walls is not measured.
std::vector<std::string> texture_names();

/// Paints one of them and writes `folder/name.png`. The same bytes on every machine of one floating-point arithmetic.
void write_texture(const std::filesystem::path& folder, const std::string& name);

}  // namespace render2mpeg::bench
