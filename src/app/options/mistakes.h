#pragma once
// Messages about command lines that cannot be read: the name first, then the right form.
#include <filesystem>
#include <string>
#include <vector>

#include "app/options/film.h"
#include "app/options/options.h"
#include "app/options/output_kind.h"

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace render2mpeg::app {

/// Refuses unknown options, with the nearest name, and --heatmap and --also without two values. `words` follow the
/// command's name. Throws UsageError.
void refuse_unknown_options(const CLI::App& program, const CLI::App& command, const std::vector<std::string>& words);

/// Refuses an unknown command. Throws UsageError.
void refuse_unknown_command(const CLI::App& program, const std::vector<std::string>& words);

/// CLI11's error in the program's own form.
std::string mistake_text(const CLI::App& command, const CLI::Error& error);

/// A line for every reason why given options change nothing.
std::vector<std::string> unused_options(const RenderOptions& options, OutputKind kind,
                                        const ToleranceRequest& tolerance, bool preview);
std::vector<std::string> unused_options(const EncodeOptions& options);

/// Note about keyframes outside the film; may be empty.
std::string unused_keyframes(const Keyframes& keyframes, const FrameRange& frames);

/// Note about keyframes of a DVD less than 0.4 s behind a unit's beginning, where no chapter can begin; may be empty.
/// Cuts are not known yet.
std::string keyframes_without_chapter(const Film& film);

/// Why a file cannot be a scene, by its ending; empty if it can. A folder needs a film.json.
std::string not_a_scene(const std::filesystem::path& file);

/// Why a file holds no frames that `encode` reads, and what does.
std::string not_frames(const std::filesystem::path& file);

/// The same for films that `info` reads.
std::string not_a_film(const std::filesystem::path& file);

/// Alternative to an ending that is not written.
std::string instead_of(const std::filesystem::path& output);

}  // namespace render2mpeg::app
