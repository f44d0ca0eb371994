#pragma once
// What the command line decides over a scene's file.
#include <optional>
#include <string>

namespace render2mpeg::scene {

/// What the command line decides over the file.
struct LoadOptions {
    std::optional<std::string> camera;     ///< name or index
    std::optional<std::string> animation;  ///< name or index of a glTF animation; none: all of them at once
    std::optional<std::string> sky;        ///< image file, or "none"
};

}  // namespace render2mpeg::scene
