#pragma once

#include <string>
#include <vector>

namespace render2mpeg::app {

/// Ascending numbers as schedulers read them: "1,3-5".
std::string part_list(const std::vector<int>& numbers);

}  // namespace render2mpeg::app
