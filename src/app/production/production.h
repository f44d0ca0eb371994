#pragma once
// Makes the frames of a film that is settled, and gives what is whole its name.
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/files/publish.h"
#include "app/files/work_folder.h"
#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/options.h"
#include "app/report/frame_view.h"
#include "app/report/side_film.h"
#include "app/report/statistics.h"
#include "app/system/error_collector.h"

namespace render2mpeg::app {

struct ChunksAtOnce {
    int count = 1;
    std::string reason;
};

/// One for every 4 threads, or as many as --chunks-at-once asks for; no more than --memory allows, else half of the
/// machine's memory where none are asked for; one where outputs go on from chunk to chunk. The film's bytes do not
/// depend on it. Images' headers are read where memory may be the limit.
ChunksAtOnce chunks_at_once(const RenderJob& film, const RenderOptions& options);

/// "4 chunks at once: 16 threads, 4 to a chunk; memory allows 9".
std::string text_of(const ChunksAtOnce& chosen);

/// As prepare(), within the memory that the options allow. Not done where an interrupt was requested meanwhile.
RenderJob prepare_within_memory(const RenderOptions& options);

/// Prints deficiencies of the scene, and options without effect.
void print_notes(const RenderJob& film, const RenderOptions& options);

/// Checks that need no scene: refuses outputs that cannot be written, and films that exist already. Call before a scene
/// is read, which may take minutes. Throws core::Error or Refusal.
void check_before_reading(const RenderOptions& options);

/// Opens the modules of all writers that the outputs need and sees that they can write them, so that what is missing is
/// told before any light is found. Writes nothing. Throws core::Error.
void open_writers(const RenderJob& film, const RenderOptions& options);

/// Refuses outputs that would replace other files, have nothing to show or cannot be written. Writes nothing. Throws
/// core::Error.
void check_outputs(const RenderJob& film, const RenderOptions& options);

/// Outputs of the film, for require_consent().
Wishes written_by(const RenderJob& film, const RenderOptions& options);

/// Sees that all outputs can be written before hours go into them; from now on no other run has the film.
std::unique_ptr<WorkFolder> open_outputs(const RenderJob& film, const RenderOptions& options,
                                         const nlohmann::json& identity);

/// Seconds on the clock of this run, and of those that it goes on from.
class WallClock {
  public:
    double seconds(const RunStatistics& statistics) const { return statistics.earlier_wall + clock_seconds() - start_; }

  private:
    double start_ = clock_seconds();
};

/// A render whose film is settled and whose outputs are open.
struct OpenRender {
    const RenderJob& film;
    const RenderOptions& options;
    const nlohmann::json& identity;
    const WallClock& clock;
    WorkFolder& work;
    SideFilms& side_films;
    SampleFrameObserver& sample_frame;
    RunStatistics& statistics;
    std::vector<ChunkFile>& files;                          ///< of whole chunks, and of the one behind them, by index
    std::function<void(std::int64_t)> frames_done = {};     ///< told of the frames that are whole, after each; or empty
    std::function<void(const ChunkFile&)> chunk_done = {};  ///< told of each chunk that is whole now; or empty
    std::vector<double> prices = {};                        ///< as prices_of() finds them, where they are known
};

/// In a chunk's record: figures for the report of the frame that it shows.
inline constexpr const char* sample_frame_name = "sample_frame";

/// Restores the report's sample frame from the records of finished chunks of an earlier run.
void take_up(SampleFrameObserver& sample_frame, const std::vector<ChunkFile>& chunks);

/// Renders the chunks that have no file yet, several at once; after an interruption the first that
/// is not whole is there incompletely. Returns whether all that the job makes is whole. The message of a failure ends
/// with the work that is preserved.
bool render_chunks(const OpenRender& open);

/// Makes the chunks that have no file yet, up to `at_once` beside each other, and adds their files and statistics to
/// the render's, in the order of the film. Of those that an interruption stopped only the one that follows the whole
/// ones is among them, incomplete. A failure stops all; throws the first one in the order of the film. Returns whether
/// all are whole.
bool make_chunks(const OpenRender& open, std::size_t at_once);

/// Writes the statistics and the report where they are asked for. Returns whether all was written.
bool write_about(const RenderJob& film, const RenderOptions& options, const RunStatistics& statistics,
                 const RunFacts& facts, const SampleFrameObserver& sample, ErrorCollector& errors);

/// Publishes complete outputs; leaves incomplete ones beside the target. Stores the outcome in `facts`. `again`: the
/// command to continue after an interruption. Returns whether all requested outputs are written. A failure does not
/// stop the other outputs; throws the first failure at the end.
bool publish_all(const OpenRender& open, bool complete, RunFacts& facts, const std::string& again);

}  // namespace render2mpeg::app
