#pragma once
#include <filesystem>
#include <string>

namespace render2mpeg::app {

/// A folder for what nobody keeps, removed with the object. Throws core::Error where none can be made.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::string file(const char* name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

}  // namespace render2mpeg::app
