#pragma once
// Wrap modes of textures outside [0, 1].
namespace render2mpeg::core {

enum class Wrap { repeat, mirrored_repeat, clamp_to_edge };

}  // namespace render2mpeg::core
