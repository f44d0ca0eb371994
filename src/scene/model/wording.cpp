#include "scene/model/wording.h"

#include <algorithm>
#include <charconv>

#include "core/error.h"

namespace render2mpeg::scene {

std::string in_quotes(std::string_view name) {
    constexpr std::size_t longest = 60;
    std::string text = "\"";
    for (const char c : name.substr(0, longest)) {
        const unsigned char code = static_cast<unsigned char>(c);
        text += code < 0x20 || code == 0x7f ? '?' : c;
    }
    // Do not cut a UTF-8 character in two.
    if (name.size() > longest) {
        while (text.size() > 1 && (static_cast<unsigned char>(text.back()) & 0xc0) == 0x80) text.pop_back();
        if (text.size() > 1 && static_cast<unsigned char>(text.back()) >= 0xc0) text.pop_back();
        text += "...";
    }
    return text + "\"";
}

std::string described(std::string_view kind, std::size_t index, std::string_view name) {
    const std::string text = std::string(kind) + " " + std::to_string(index);
    return name.empty() ? text : text + " " + in_quotes(name);
}

void note_once(Animation& animation, const std::string& line) {
    if (std::find(animation.notes.begin(), animation.notes.end(), line) == animation.notes.end())
        animation.notes.push_back(line);
}

void refuse(const Animation& animation, const std::string& object, const std::string& cause) {
    throw core::Error("reading", animation.source, object, cause);
}

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
