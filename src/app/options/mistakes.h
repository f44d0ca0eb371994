#pragma once
// What is told of a command line that cannot be read: the name first, then what would be right.
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

/// Refuses options that the command does not have, and options of two words that lack one. `words`: those behind the
/// command's name. `program` has all commands. Throws UsageError, with the option that may have been meant.
void refuse_unknown_options(const CLI::App& program, const CLI::App& command, const std::vector<std::string>& words);

/// Refuses a first word that is no command. Throws UsageError.
void refuse_unknown_command(const CLI::App& program, const std::vector<std::string>& words);

/// What CLI11 found wrong in the words of a command, in the program's own form.
std::string mistake_text(const CLI::App& command, const CLI::Error& error);

/// One line for every reason why options that were given change nothing in this run; none where all count.
std::vector<std::string> unused_options(const RenderOptions& options, OutputKind kind,
                                        const ToleranceRequest& tolerance);
std::vector<std::string> unused_options(const EncodeOptions& options);

/// A line about keyframes that are no frames of the film; empty where all are.
std::string unused_keyframes(const Keyframes& keyframes, const FrameRange& frames);

/// A line about keyframes of a DVD's film at which no chapter can begin, since a unit of its stream begins less than
/// 0.4 s before; empty where there is none. Cuts, which are found while frames are made, are not looked at.
std::string keyframes_without_chapter(const Film& film);

/// Why a file cannot be a scene, and what to do with it; empty where its ending does not say so. A folder is none
/// without a film.json; the scenes in it are named.
std::string not_a_scene(const std::filesystem::path& file);

/// The same of films that `info` reads.
std::string not_a_film(const std::filesystem::path& file);

/// What to write instead of a file with an ending that is not written.
std::string instead_of(const std::filesystem::path& output);

}  // namespace render2mpeg::app
