#pragma once
// Settings of the command line that override a scene's file.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace render2mpeg::scene {

/// Light of a film without any: a studio (preparation/default_light.h), an even sky, or none.
enum class DefaultLight { studio, even, none };

/// Options that win over the file.
struct LoadOptions {
    std::optional<std::string> camera{};     ///< name or index
    std::optional<std::string> animation{};  ///< name or index of a glTF animation; none: all of them at once
    std::optional<std::string> sky{};        ///< image file, or "none"
    std::optional<std::string> variant{};    ///< name or index of one of glTF's variants of materials
    DefaultLight light = DefaultLight::studio;
    int lines = 0;  ///< height of the pictures, in pixels, for which Blender bakes textures; 0: the .blend's own
    std::optional<std::int64_t> last_frame{};  ///< of the film at its own rate, after which Blender exports nothing
    std::function<bool()> stops{};             ///< whether Blender's export is to be given up; empty: never
    std::function<void(const std::string&)> tells{};  ///< gets the step of that export; empty: nobody asks
};

}  // namespace render2mpeg::scene
