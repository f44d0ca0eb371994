#pragma once
// A finished chunk on disk: its stream, and the record that proves it whole.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "app/files/file_io.h"
#include "app/options/film.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// What is remembered of a coded picture until the film is put together.
struct PictureRecord {
    std::int64_t number = 0;        ///< display number, absolute
    std::int64_t coding_order = 0;  ///< within its chunk
    bool starts_gop = false;
    std::uint64_t bytes = 0;
    std::uint64_t checksum = 0;  ///< of its reconstruction
};

/// The coded pictures of one chunk, in coding order, in a file that grows while the chunk is rendered.
class ChunkFile {
  public:
    ChunkFile(const std::filesystem::path& file, const Chunk& chunk);
    /// A chunk that an earlier run finished; none where there is none, or what there is of it is damaged.
    static std::optional<ChunkFile> reopened(const std::filesystem::path& file, const Chunk& chunk);

    void append(const encoder::CodedPicture& coded);
    /// Closes the stream and writes its record beside it (`.json`), which marks the chunk as complete. `facts` stands
    /// in the record for whoever goes on after it. Throws core::Error.
    void finish(const nlohmann::json& facts);
    /// Closes the stream as it is: playable, not complete.
    void abandon();

    const Chunk& chunk() const { return chunk_; }
    const std::filesystem::path& file() const { return file_; }
    const std::vector<PictureRecord>& pictures() const { return pictures_; }
    /// Bits in the decoder's buffer before its first picture is taken out, and before that of the chunk behind it.
    std::int64_t vbv_in() const { return vbv_in_; }
    std::int64_t vbv_out() const { return vbv_out_; }
    /// What finish() was told; throws core::Error where the record cannot be read.
    nlohmann::json facts() const;

    /// The record beside a chunk's file.
    static std::filesystem::path record_of(const std::filesystem::path& file);

  private:
    /// Without a stream.
    ChunkFile(std::filesystem::path file, const Chunk& chunk, std::vector<PictureRecord> pictures);

    std::filesystem::path file_;
    Chunk chunk_;
    std::ofstream stream_;
    std::vector<PictureRecord> pictures_;
    Checksum checksum_;                      ///< of the stream
    std::int64_t vbv_in_ = 0, vbv_out_ = 0;  ///< buffer fullness that the chunk finds, and leaves to the next
};

}  // namespace render2mpeg::app
