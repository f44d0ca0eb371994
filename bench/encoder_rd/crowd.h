#pragma once

#include <filesystem>

namespace render2mpeg::bench {

/// Writes crowd.gltf into `folder`, with the files that it needs: several of the figure in `character`
/// (animations/character), each with a place, a heading and a pace of its own. Throws core::Error.
void write_crowd(const std::filesystem::path& character, const std::filesystem::path& folder);

}  // namespace render2mpeg::bench
