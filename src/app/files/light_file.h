#pragma once
// Light that films found on their surfaces, in a file for later runs.
#include <array>
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
/// add to one. The next block is written over the remains of one that a killed run left.
class LightFile {
  public:
    /// `identity`: all that decides the light (resume.h). The file may be missing.
    LightFile(const std::filesystem::path& file, const nlohmann::json& identity);

    /// What it holds now. Throws core::Error, naming the difference, where it is of other light, or no light file.
    LightExtent extent() const;
    /// Light of its beginning. Throws core::Error where that is another now.
    std::vector<std::byte> known(const LightExtent& beginning) const;
    /// Adds a block. Throws core::Error, also where the file is full: 1 GiB.
    void add(std::span<const std::byte> light);

  private:
    std::size_t whole_of(std::string_view text, std::size_t from = 0) const;

    std::filesystem::path file_;
    std::shared_ptr<const nlohmann::json> identity_;
    std::size_t added_to_ = 0;               ///< bytes of the file after the last `add`
    std::array<std::uint64_t, 2> number_{};  ///< of the file then
};

}  // namespace render2mpeg::app
