#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/files/work_folder.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/options.h"

/// How a run goes on where another one was interrupted or killed (docs/first-film.md).
namespace render2mpeg::app {

/// Where the frames of a chunk are written that are not coded: an uncompressed film's part in the work folder, or
/// numbered images under their own names.
std::filesystem::path frames_of(const RenderJob& film, const RenderOptions& options, const WorkFolder& work,
                                const Chunk& chunk);

/// What the record of a chunk says for who goes on after it: the statistics so far, and checksums of the files that
/// came of its frames.
nlohmann::json chunk_record_of(const RenderJob& film, const RenderOptions& options, const WorkFolder& work,
                               const Chunk& chunk, const RunStatistics& so_far);

/// Marks a whole film by an extended attribute of its first file: a checksum of its identity and of all files made with
/// it. Does nothing on file systems without such attributes.
void mark_as_whole(const RenderJob& film, const RenderOptions& options, const nlohmann::json& identity);

/// Whether the film of --resume has this mark and all its files are unchanged. Says so, and removes the leftovers of a
/// run that was killed at its very end.
bool is_done_already(const RenderJob& film, const RenderOptions& options, const nlohmann::json& identity);

/// The whole chunks of an earlier run, whose statistics are taken in; what else there was is removed, after `kept`
/// was told how many are taken over. None where the options ask for none.
std::vector<ChunkFile> take_up(const RenderJob& film, const RenderOptions& options, WorkFolder& work,
                               const std::function<void(std::size_t)>& kept, RunStatistics& statistics);

/// Finds out what is settled before the first frame, or takes it over from the earlier run: the exposure, and what a
/// first pass says. `work`: where it is kept for later runs; null: nowhere.
void settle(RenderJob& film, const RenderOptions& options, WorkFolder* work, RunStatistics& statistics);
inline void settle(RenderJob& film, const RenderOptions& options, WorkFolder& work, RunStatistics& statistics) {
    settle(film, options, &work, statistics);
}

/// What a later run of `command` with --resume would make of these chunks, as a part of a sentence.
std::string resuming_text(const RenderJob& film, std::size_t whole_chunks,
                          const std::string& command = "the same command");

}  // namespace render2mpeg::app
