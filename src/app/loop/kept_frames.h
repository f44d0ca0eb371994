#pragma once
// Lit frames of a chunk in the making, kept for a run that goes on in its midst.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "core/archive.h"
#include "core/picture.h"

namespace render2mpeg::app {

/// What KeptFrames is to know of a chunk.
struct KeptChunk {
    std::filesystem::path stream;  ///< beside which the files lie: `.lit`, pictures, and `.state`, the rest
    Chunk chunk;
    std::string film;             ///< its identity
    int width = 0, height = 0;    ///< of pictures
    bool needs_pictures = false;  ///< their coding is repeated
    bool unrounded = false;       ///< with Picture::luma, which codecs of ten bits take
    core::ExactChroma chroma = core::ExactChroma::none;
    bool alpha = false;                                                          ///< with Picture::alpha
    std::function<std::vector<std::filesystem::path>(std::int64_t)> products{};  ///< files that a frame has already
    std::function<void(RunStatistics&)> add_times = [](RunStatistics&) {};       ///< of the run, to those of the chunk
};

/// A chunk's frames so far: pictures, which are coded again, and the state in which they left what lights the next one.
/// Both are written while frames are lit: a signal costs the frame at hand, a kill what is lit in twenty times as long
/// as they took to write.
class KeptFrames {
  public:
    /// Takes over what an earlier run left, if it is whole, of this film, and its products are unchanged.
    explicit KeptFrames(KeptChunk chunk);

    /// Frames that a run may go on behind.
    std::int64_t frames() const { return frames_; }
    /// Why what was left is of no use; empty: it is, or nothing was left.
    const std::string& complaint() const { return complaint_; }

    /// The next picture of those that were left.
    core::Picture next(std::int64_t number);
    /// State behind the last of them, and statistics of them.
    std::unique_ptr<core::ArchiveReader> state() { return std::move(state_); }
    const nlohmann::json& statistics() const { return head_.at("statistics"); }

    /// Takes the picture of a frame that was just lit.
    void add(core::Picture picture);
    /// Keeps the frames so far, whose state `save` writes, if that is due or wanted at once. A full disk ends it, and
    /// no frame is kept.
    void keep(RunStatistics statistics, bool at_once, const std::function<void(core::ArchiveWriter&)>& save);

    /// Removes the files: the chunk is whole, or they are of no use.
    void drop();

    /// Frames that seem to be kept beside a chunk's stream.
    static std::int64_t left_beside(const std::filesystem::path& stream, const Chunk& chunk);

  private:
    std::uint64_t mark() const;
    std::string why_not(const std::filesystem::path& state);
    core::Picture empty() const;
    bool read(core::Picture& picture);
    nlohmann::json sums_of_products(std::int64_t frame) const;

    KeptChunk chunk_;
    std::filesystem::path lit_, state_file_;
    std::int64_t frames_ = 0;
    std::string complaint_;
    nlohmann::json head_;  ///< `statistics`, and by frame checksums of `pictures` and `products`
    std::unique_ptr<core::ArchiveReader> state_;
    std::ifstream earlier_;  ///< pictures that were left
    std::ofstream stream_;
    bool ends_ = false;  ///< the disk is full
    double due_ = 0;     ///< clock_seconds()
};

/// Frames that seem to be kept beside these chunks' streams in an output's work folder.
std::int64_t lit_frames_in(const std::filesystem::path& output, const std::vector<Chunk>& chunks);

}  // namespace render2mpeg::app
