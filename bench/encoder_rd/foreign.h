#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Films that this program did not render: made by ffmpeg's own sources, without motion.
namespace render2mpeg::bench {

bool is_foreign(const std::string& name);

/// Words of the ffmpeg command that describe a clip's input. `texture` gives the file of a texture by its name.
std::vector<std::string> foreign_source(const std::string& name, const std::string& size,
                                        const std::function<std::string(const std::string&)>& texture);

/// Has ffmpeg write so many pictures, 30 Hz, 4:2:0. Throws core::Error where it fails.
void write_foreign(const std::vector<std::string>& source, int pictures, const std::filesystem::path& file);

}  // namespace render2mpeg::bench
