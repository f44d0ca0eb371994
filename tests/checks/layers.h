#pragma once

#include <vector>

#include "checks/tree.h"

namespace render2mpeg::checks {

/// Includes that break the house's arrows: parts that may not know each other, headers not spelled from an include
/// root, outside libraries outside their part, in more files than they may be, or unknown to the table.
std::vector<Finding> layer_breaches(const std::vector<File>& files);

}  // namespace render2mpeg::checks
