#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/model/animation.h"

/// How the scene's messages name things, so that all of them read alike.
namespace render2mpeg::scene {

/// A name out of a file in quotation marks: on one line, at most 60 characters, whatever it holds.
std::string in_quotes(std::string_view name);

/// `mesh 3 "Chair"`, or `mesh 3` for things without a name.
std::string described(std::string_view kind, std::size_t index, std::string_view name);

/// `1 triangle`, `2 triangles`.
std::string counted(std::size_t count, std::string_view noun);

/// Adds a line to Animation::notes unless it is there already.
void note_once(Animation& animation, const std::string& line);

/// For what is wrong with a loaded film: always throws core::Error.
[[noreturn]] void refuse(const Animation& animation, const std::string& object, const std::string& cause);

/// The first thing of that name, else the one of that index (from 0).
std::optional<std::size_t> choose(const std::string& wanted, const std::vector<std::string>& names);

/// `no camera "x"; there are 0 "a", 1 "b"`.
std::string no_such(const std::string& kind, const std::string& wanted, const std::vector<std::string>& names);

}  // namespace render2mpeg::scene
