#pragma once
// What is told of a command line that cannot be read: the name first, then what would be right.
#include <string>
#include <vector>

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

}  // namespace render2mpeg::app
