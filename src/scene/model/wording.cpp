#include "scene/model/wording.h"

#include <algorithm>

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

std::string counted(std::size_t count, std::string_view noun) {
    return std::to_string(count) + " " + std::string(noun) + (count == 1 ? "" : "s");
}

void note_once(Animation& animation, const std::string& line) {
    if (std::find(animation.notes.begin(), animation.notes.end(), line) == animation.notes.end())
        animation.notes.push_back(line);
}

void refuse(const Animation& animation, const std::string& object, const std::string& cause) {
    throw core::Error("reading", animation.source, object, cause);
}

}  // namespace render2mpeg::scene
