#pragma once

#include <filesystem>
#include <functional>

namespace render2mpeg::scene {

/// Runs `reading` in a child process first, whose memory and time are limited by the size of `file`: for outside
/// parsers, which hostile files can make crash, loop or take all memory. Throws core::Error if the child dies, and what
/// `reading` threw as core::Error there; returns if it went well, so that doing the same in this process will as well.
/// Nothing the child does or prints is seen.
void try_in_child(const std::filesystem::path& file, const std::function<void()>& reading);

}  // namespace render2mpeg::scene
