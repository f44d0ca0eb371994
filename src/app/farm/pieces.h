#pragma once
// Finished chunks as single files: for machines that share no folder.
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "app/farm/farm_plan.h"
#include "app/files/chunk_file.h"
#include "app/job/render_job.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// Writes the chunks of a part as pieces into a folder, and has a command bring each of them away.
class PieceSender {
  public:
    /// `options`: of the part. `wish`: folder and command. Throws core::Error where the folder cannot be made.
    PieceSender(const FarmPlan& plan, const FilmPart& part, const RenderJob& film, const RenderOptions& options,
                const PartOptions& wish);

    /// Brings chunks of earlier tries; writes those that are no whole pieces yet.
    void begin(const std::vector<ChunkFile>& earlier);
    /// Of any thread.
    void send(const ChunkFile& chunk);
    /// Tries again what could not be brought. Returns false after an interruption. Throws core::Error where that fails,
    /// too.
    bool finish();

  private:
    void write(const ChunkFile& chunk) const;
    void bring(const std::filesystem::path& piece);
    void bring_again();

    const FarmPlan& plan_;
    const FilmPart& part_;
    const RenderJob& film_;
    const RenderOptions& options_;
    std::filesystem::path folder_, from_;
    std::vector<std::string> command_;            ///< words; empty: pieces stay
    std::vector<std::filesystem::path> waiting_;  ///< could not be brought yet
    std::string failure_;                         ///< of the last one
    std::mutex mutex_;
};

/// Takes the pieces in a folder and those below it into the plan's parts, as if they had been made here, where their
/// chunks are not there yet. `parts`: others are not looked at. Returns a line for each piece that is refused. Throws
/// core::Error where there is no such folder, or this one cannot be written.
std::vector<std::string> take_pieces(const FarmPlan& plan, std::span<const FilmPart> parts,
                                     const std::filesystem::path& from);

}  // namespace render2mpeg::app
