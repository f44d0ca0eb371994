#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/files/light_file.h"
#include "app/files/publish.h"
#include "app/files/work_folder.h"
#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// Files of the scene, the named one first; some may be missing.
std::vector<std::filesystem::path> scene_files_of(const RenderJob& film, const RenderOptions& options);

/// All that decides a film's bytes: version, build, instruction set, frames, options and inputs' checksums. Throws
/// core::Error where an input cannot be read.
nlohmann::json identity_of(const RenderJob& film, const RenderOptions& options);

/// The same for a film of finished frames, which cannot be resumed: its command and folder.
nlohmann::json identity_of(const Film& film, const std::string& command);

/// Why --light-cache has no effect, in words; empty where it has.
std::string why_no_light_file(const RenderJob& film);

/// The film's light file; none where there is none, or it has no effect.
std::optional<LightFile> light_file_of(const RenderJob& film, const RenderOptions& options);

std::vector<Files> inputs_of(const RenderJob& film, const RenderOptions& options);

/// Place of a chunk's uncoded frames: its Y4M part in the work folder, or numbered images.
std::filesystem::path frames_of(const RenderJob& film, const RenderOptions& options, const WorkFolder& work,
                                const Chunk& chunk);

/// Files that a frame has beside the film: images, layers.
std::vector<std::filesystem::path> images_of(const RenderJob& film, const RenderOptions& options,
                                             const FrameRange& frames);

/// Record of a chunk: its statistics, and checksums of its files.
nlohmann::json chunk_record_of(const RenderJob& film, const RenderOptions& options, const WorkFolder& work,
                               const Chunk& chunk, const RunStatistics& statistics);

/// Marks a whole film by an extended attribute of its first file: a checksum of identity and files. Without such
/// attributes nothing happens.
void mark_as_whole(const RenderJob& film, const RenderOptions& options, const nlohmann::json& identity);

/// Whether --resume finds this mark and unchanged files. Says so.
bool is_done_already(const RenderJob& film, const RenderOptions& options, const nlohmann::json& identity);

/// Takes over the whole chunks of an earlier run with their statistics, gaps or not, and removes the rest, after `kept`
/// got them. None without --resume.
std::vector<ChunkFile> take_up(const RenderJob& film, const RenderOptions& options, WorkFolder& work,
                               const std::function<void(const std::vector<ChunkFile>&)>& kept,
                               RunStatistics& statistics);

/// Settles exposure, first pass and the extent of known light, or takes them over from an earlier run. `work`: kept
/// there; null: nowhere.
void settle(RenderJob& film, const RenderOptions& options, WorkFolder* work, RunStatistics& statistics);
inline void settle(RenderJob& film, const RenderOptions& options, WorkFolder& work, RunStatistics& statistics) {
    settle(film, options, &work, statistics);
}

/// Whether a later run goes on from these chunks.
bool is_of_use(const std::vector<ChunkFile>& files);

/// Effect of `command` with --resume on these chunks, as a part of a sentence.
std::string resuming_text(const RenderJob& film, const std::vector<ChunkFile>& files,
                          const std::string& command = "the same command");

}  // namespace render2mpeg::app
