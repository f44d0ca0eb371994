#pragma once
// A finished chunk on disk: its stream, and the record that proves it whole.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "app/files/file_io.h"
#include "app/options/film.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Record of a coded picture.
struct PictureRecord {
    std::int64_t number = 0;        ///< display number, absolute
    std::int64_t coding_order = 0;  ///< within its chunk
    bool starts_gop = false;
    std::uint64_t bytes = 0;
    std::uint64_t checksum = 0;  ///< of its reconstruction
};

/// Coded pictures of one chunk in a growing file.
class ChunkFile {
  public:
    ChunkFile(const std::filesystem::path& file, const Chunk& chunk);
    /// Reopens a finished chunk; none where it is missing or damaged.
    static std::optional<ChunkFile> reopened(const std::filesystem::path& file, const Chunk& chunk);

    void append(const encoder::CodedPicture& coded);
    /// Closes the stream and writes its record (`.json`), which marks the chunk as whole and keeps `facts`. Throws
    /// core::Error.
    void finish(const nlohmann::json& facts);
    /// Closes an unfinished stream, which stays playable. `lit`: its first frames that are kept beside it.
    void abandon(std::int64_t lit = 0);
    std::int64_t lit() const { return lit_; }

    const Chunk& chunk() const { return chunk_; }
    const std::filesystem::path& file() const { return file_; }
    const std::vector<PictureRecord>& pictures() const { return pictures_; }
    /// Facts given to finish(). Throws core::Error.
    nlohmann::json facts() const;

    static std::filesystem::path record_of(const std::filesystem::path& file);

  private:
    ChunkFile(std::filesystem::path file, const Chunk& chunk, std::vector<PictureRecord> pictures);

    std::filesystem::path file_;
    Chunk chunk_;
    std::ofstream stream_;
    std::vector<PictureRecord> pictures_;
    Checksum checksum_;  ///< of the stream
    std::int64_t lit_ = 0;
};

inline int index_of(const ChunkFile& file) {
    return file.chunk().index;
}

/// Whether it was finished.
bool is_whole(const ChunkFile& chunk);

/// Of files by index those from the film's `first` chunk on without a gap; the last of them may be incomplete.
std::span<const ChunkFile> leading_of(std::span<const ChunkFile> files, int first);

}  // namespace render2mpeg::app
