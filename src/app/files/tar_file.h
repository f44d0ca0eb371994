#pragma once

#include <filesystem>
#include <vector>

namespace render2mpeg::app {

/// Writes files into one archive that `tar` and POSIX's `pax` read [POSIX, pax, ustar], whole or not at all. Names in
/// it begin behind `folder`, which all files are in; owners and times are left out, so that the same files give the
/// same bytes. Throws core::Error, also where a name is longer than the format holds (100 bytes, or 255 with its
/// folders).
void write_tar(const std::filesystem::path& archive, const std::filesystem::path& folder,
               const std::vector<std::filesystem::path>& files);

}  // namespace render2mpeg::app
