#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "checks/tree.h"

namespace render2mpeg::checks {

/// Lines that a file may have: a file that outgrows this has found a second duty.
inline constexpr int longest_file = 500;
/// Lines that a function may have: past it, it is two functions.
inline constexpr int longest_function = 60;

/// Bytes that a file of the repository may have, of whatever kind: every clone takes all of them, for ever.
inline constexpr std::uintmax_t largest_file = 1'000'000;

/// Files that git tracks, or would at `git add .`, beyond those bytes; none where `root` is no work tree.
std::vector<Finding> large_files(const std::filesystem::path& root);

std::vector<Finding> oversized_files(const std::vector<File>& files);

/// A function's body by its indentation, which clang-format guarantees.
struct Function {
    std::string head;  ///< its first line
    int line = 0;
    int lines = 0;
};
std::vector<Function> functions_in(const File& file);

/// Functions beyond the length, in product files only.
std::vector<Finding> oversized_functions(const std::vector<File>& files);

}  // namespace render2mpeg::checks
