#pragma once

#include <string>
#include <vector>

#include "checks/tree.h"

namespace render2mpeg::checks {

/// Lines that a file may have: a file that outgrows this has found a second duty. Tests grow by cases, and may be
/// longer.
inline constexpr int longest_source = 350;
inline constexpr int longest_test = 500;
/// Lines that a function should have; past it, it is two functions. The loop of the whole program must.
inline constexpr int longest_function = 60;

std::vector<Finding> oversized_files(const std::vector<File>& files);

/// A function's body by its indentation, which clang-format guarantees.
struct Function {
    std::string head;  ///< its first line
    int line = 0;
    int lines = 0;
};
std::vector<Function> functions_in(const File& file);

/// Functions beyond the length, in product files only. A warning, but for `src/app/loop/pipeline.cpp`, whose loop stays
/// on a page.
std::vector<Finding> oversized_functions(const std::vector<File>& files);

}  // namespace render2mpeg::checks
