#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace render2mpeg::scene {

/// Finds the images that a scene names, within the scene's own folder. Old formats write names as some other machine
/// saw them: with its folders, backslashes, in other letter case, or cut to the 8.3 names of DOS ("MRAMOR~1.tga" for
/// "mramor-floor.jpg").
class TextureFinder {
  public:
    explicit TextureFinder(const std::filesystem::path& folder);

    /// The file meant by `written`, or nothing. Tried in this order: the path as written, below the folder, ignoring
    /// letter case; its base name in the folder, in `textures`, and in the other folders beside; the same with another
    /// image ending; the 8.3 name. Nothing outside of the scene's folder is ever looked at.
    std::optional<std::filesystem::path> find(const std::string& written) const;

  private:
    struct Entry {
        std::filesystem::path path;
        std::string relative;  ///< lower case, '/' between folders
        std::string name;      ///< lower case base name
        std::string stem, ending;
    };

    const Entry* by_short_name(const std::string& name) const;

    std::vector<Entry> files_;  ///< images, the nearest folders first, then by name
};

}  // namespace render2mpeg::scene
