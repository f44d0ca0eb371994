#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/chunk.h"
#include "app/film.h"
#include "app/ledger.h"
#include "app/output_lock.h"
#include "core/picture.h"
#include "encoder/encoder.h"

namespace render2mpeg::app {

/// What is remembered of a coded picture until the film is put together.
struct PictureRecord {
    std::int64_t number = 0;        ///< display number, absolute
    std::int64_t coding_order = 0;  ///< within its chunk
    bool starts_gop = false;
    std::uint64_t bytes = 0;
    std::uint64_t checksum = 0;  ///< of its reconstruction
};

/// A 64-bit checksum of a picture's three planes. [FNV]
std::uint64_t checksum_of(const core::Picture& picture);

/// The coded pictures of one chunk, in coding order, in a file that grows while the chunk is rendered.
class ChunkFile {
  public:
    ChunkFile(const std::filesystem::path& file, const Chunk& chunk);

    void append(const encoder::CodedPicture& coded);
    /// Closes the stream and writes its record beside it (`.json`), which marks the chunk as complete.
    void finish(const std::vector<FrameEntry>& frames);
    /// Closes the stream as it is: playable, not complete.
    void abandon();

    const Chunk& chunk() const { return chunk_; }
    const std::filesystem::path& file() const { return file_; }
    const std::vector<PictureRecord>& pictures() const { return pictures_; }

  private:
    std::filesystem::path file_;
    Chunk chunk_;
    std::ofstream stream_;
    std::vector<PictureRecord> pictures_;
    std::int64_t vbv_in_ = 0, vbv_out_ = 0;  ///< buffer fullness that the chunk finds, and leaves to the next
};

/// `OUT.partial/`, e.g. `film.mpg.partial/`: what there is of a film that is not whole yet, with a manifest of what it
/// belongs to. No other run can have the same one meanwhile.
class WorkFolder {
  public:
    /// Creates the folder, empty but for manifest and lock; what an earlier run left there is removed. Throws
    /// core::Error where another run is at work in it, or where it is not ours to empty.
    WorkFolder(const std::filesystem::path& output, const Film& film, const std::string& command);
    /// A folder in which nothing was begun goes, unless it knows of leftovers. All else is left as it is.
    ~WorkFolder();
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;

    /// Throws as the constructor would, and changes nothing.
    static void check(const std::filesystem::path& output);

    ChunkFile open(const Chunk& chunk);
    /// A file of that name in the folder, which is begun now.
    std::filesystem::path begin(const std::string& name);
    /// The same for a file that is of no use alone: the folder goes with the object all the same.
    std::filesystem::path place(const std::string& name) const { return folder_ / name; }
    /// Gives a file with a part of the film a name beside the film that nobody has, and remembers it as a leftover.
    /// Returns the name. Throws core::Error.
    std::filesystem::path leave(const std::filesystem::path& file);
    /// When the film is whole: removes what interrupted runs of the same command left of it, where nobody has changed
    /// that since, and the folder.
    void clear_away();
    /// Removes the folder with all that it holds.
    void remove();

  private:
    /// Leftovers that an earlier run of the same film recorded.
    nlohmann::json earlier_leftovers() const;
    void write_manifest();

    std::filesystem::path output_, folder_;
    OutputLock lock_;
    std::unique_ptr<nlohmann::json> manifest_;
    bool begun_ = false, removed_ = false;
};

/// Joins chunks to one film `file`, whose format the ending of `name` tells.
void assemble(const std::vector<ChunkFile>& chunks, const Film& film, const std::filesystem::path& file,
              const std::filesystem::path& name);

/// Decodes the film and throws core::Error unless every picture equals its recorded reconstruction bit for bit.
void verify(const std::filesystem::path& film, const std::vector<ChunkFile>& chunks);

}  // namespace render2mpeg::app
