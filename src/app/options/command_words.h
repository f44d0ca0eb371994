#pragma once
// Writes a command line for another command of this program.
#include <string>
#include <utility>
#include <vector>

namespace render2mpeg::app {

/// The words of another command of this program with the same options, but for those of `without`, and with those of
/// `with` at its end: each a name and a value (empty: none). Of `without`, names in `flags` take no value.
std::vector<std::string> changed_command(const std::vector<std::string>& words, const std::string& command,
                                         const std::vector<std::string>& without, const std::vector<std::string>& flags,
                                         const std::vector<std::pair<std::string, std::string>>& with);

/// The words as a line for a shell.
std::string line_of(const std::vector<std::string>& words);

}  // namespace render2mpeg::app
