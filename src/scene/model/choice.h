#pragma once

#include <optional>
#include <string>
#include <vector>

/// Cameras and animations are chosen by name or by index.
namespace render2mpeg::scene {

/// The first thing of that name, else the one of that index (from 0).
std::optional<std::size_t> choose(const std::string& wanted, const std::vector<std::string>& names);

/// `no camera "x"; there are 0 "a", 1 "b"`.
std::string no_such(const std::string& kind, const std::string& wanted, const std::vector<std::string>& names);

}  // namespace render2mpeg::scene
