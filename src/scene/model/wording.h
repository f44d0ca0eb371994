#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// A quoted name on one line, at most 60 characters.
std::string in_quotes(std::string_view name);

/// `mesh 3 "Chair"`, or `mesh 3` for things without a name.
std::string described(std::string_view kind, std::size_t index, std::string_view name);

void note_once(Animation& animation, const std::string& line);

/// Throws core::Error.
[[noreturn]] void refuse(const Animation& animation, const std::string& object, const std::string& cause);

/// Index by name, else by number.
std::optional<std::size_t> choose(const std::string& wanted, const std::vector<std::string>& names);

/// `no camera "x"; there are 0 "a", 1 "b"`.
std::string no_such(const std::string& kind, const std::string& wanted, const std::vector<std::string>& names);

}  // namespace render2mpeg::scene
