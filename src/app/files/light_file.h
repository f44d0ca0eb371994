#pragma once
// Light that films found on their surfaces, in a file for later runs.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace render2mpeg::app {

/// The beginning of a light file: a run knows what it holds, whatever others add behind it.
struct LightExtent {
    std::uint64_t bytes = 0;
    std::uint64_t checksum = 0;
    bool operator==(const LightExtent&) const = default;
};

/// Whole blocks of light behind what it is light of. A file grows by whole blocks, under a lock, so that many runs may
/// add to one; what a killed run left of a block is overwritten by the next.
class LightFile {
  public:
    /// `identity`: all that decides the light (resume.h). The file may be missing.
    LightFile(std::filesystem::path file, const nlohmann::json& identity);

    /// What it holds now. Throws core::Error, naming the difference, where it is of other light, or no light file.
    LightExtent extent() const;
    /// Light of its beginning. Throws core::Error where that is another now.
    std::vector<std::byte> known(const LightExtent& beginning) const;
    /// Adds a block, unless the file is full: 2 GiB. Throws core::Error.
    void add(std::span<const std::byte> light);

  private:
    std::size_t whole_of(std::string_view text, std::size_t from = 0) const;

    std::filesystem::path file_;
    std::shared_ptr<const nlohmann::json> identity_;
    std::size_t added_to_ = 0;  ///< bytes of the file after the last `add`
};

}  // namespace render2mpeg::app
