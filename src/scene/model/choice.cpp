#include "scene/model/choice.h"

#include <algorithm>
#include <charconv>

#include "scene/model/wording.h"

namespace render2mpeg::scene {

std::optional<std::size_t> choose(const std::string& wanted, const std::vector<std::string>& names) {
    const auto named = std::find(names.begin(), names.end(), wanted);
    if (named != names.end()) return static_cast<std::size_t>(named - names.begin());
    std::size_t index = 0;
    const auto [end, failure] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    if (failure != std::errc() || end != wanted.data() + wanted.size() || index >= names.size()) return std::nullopt;
    return index;
}

std::string no_such(const std::string& kind, const std::string& wanted, const std::vector<std::string>& names) {
    std::string line = "no " + kind + " " + in_quotes(wanted);
    if (names.empty()) return line + "; there are none";
    line += "; there " + std::string(names.size() == 1 ? "is" : "are") + ":";
    for (std::size_t i = 0; i < names.size(); ++i)
        line += (i > 0 ? ", " : " ") + std::to_string(i) + " " + in_quotes(names[i]);
    return line;
}

}  // namespace render2mpeg::scene
