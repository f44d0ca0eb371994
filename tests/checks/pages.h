#pragma once

#include <string>
#include <vector>

#include "checks/tree.h"

/// Pages that are made from the sources: where what is.
namespace render2mpeg::checks {

/// What a file is for: the first sentence of its first comment; empty where it has none.
std::string duty_of(const File& file);

/// A page of the build, structure.md: every product file by room, a header and its source as one, with its duty.
std::string structure_page(const std::vector<File>& files);

/// Product files, or pairs of them, of which no comment says what they are for.
std::vector<Finding> files_without_duty(const std::vector<File>& files);

/// A page of the build, equations.md: every place of every work that the product cites, with the files that follow it
/// and the pages that explain it.
std::string equations_page(const std::vector<File>& files);

}  // namespace render2mpeg::checks
