#pragma once

#include <vector>

#include "checks/tree.h"

namespace render2mpeg::checks {

/// Includes that break the arrows between rooms, the folders inside a part: rooms that may not know each other, a room
/// that includes a header of the part's own level (the part is built on its rooms), parts that a room may not know, and
/// sources in a folder that is no room of the table. Rooms may include a part's values, which include no room.
std::vector<Finding> room_breaches(const std::vector<File>& files);

/// Rooms without a README.md, or with one of more than ten lines.
std::vector<Finding> rooms_without_readme(const std::vector<File>& files);

/// READMEs of rooms whose sentence "May touch ..." names other rooms than the table, and READMEs of large rooms that
/// leave out a file of their folder.
std::vector<Finding> untrue_readmes(const std::vector<File>& files);

}  // namespace render2mpeg::checks
