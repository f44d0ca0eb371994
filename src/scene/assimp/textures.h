#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace render2mpeg::scene {

/// Finds a scene's images in its folder, though old formats write foreign folders, backslashes, other letter case, or
/// 8.3 names ("MRAMOR~1.tga" for "mramor-floor.jpg").
class TextureFinder {
  public:
    explicit TextureFinder(const std::filesystem::path& folder);

    /// File of `written`, tried in order: its path regardless of case; its base name in the folder, `textures` and
    /// other folders; another image ending; its 8.3 name. Never outside the scene's folder.
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
