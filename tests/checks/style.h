#pragma once

#include <vector>

#include "checks/tree.h"

namespace render2mpeg::checks {

/// Marks of unfinished work, merge conflicts, tabs, CRLF, blanks at a line's end, a last line without end, more than
/// one empty line at the end, paths of somebody's machine. In every text file.
std::vector<Finding> leftovers(const std::vector<File>& files);

/// In C++ files: names the house does not use (get_..., ...Manager), what g++ 12 or clang 14 lacks, headers without
/// #pragma once.
std::vector<Finding> unhouselike_names(const std::vector<File>& files);

/// In product files outside src/app: parts never print and never exit; nowhere in the product random numbers with a
/// state, which depend on the order of calls and so on threads.
std::vector<Finding> forbidden_calls(const std::vector<File>& files);

}  // namespace render2mpeg::checks
