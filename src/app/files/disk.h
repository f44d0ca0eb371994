#pragma once
// Makes sure that bytes are on the disk.
#include <filesystem>

namespace render2mpeg::app {

/// Waits until a file's bytes are on the disk, so that nothing that is written later survives them when the power
/// fails. Throws core::Error where they cannot be kept; that a file system knows no such thing is no failure.
void bring_to_disk(const std::filesystem::path& file);

/// Likewise for the names in the folder that `file` is in.
void bring_name_to_disk(const std::filesystem::path& file);

/// A file's full name with all links followed, whether it is there or not.
std::filesystem::path canonical_of(const std::filesystem::path& file);

}  // namespace render2mpeg::app
