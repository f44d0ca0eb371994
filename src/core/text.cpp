#include "core/text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace render2mpeg::core {
namespace {

/// A character at the beginning of a text.
struct Character {
    std::size_t bytes = 1;
    bool shown = false;  ///< it is UTF-8, and does nothing to a terminal but be seen
};

bool is_shown(std::uint32_t code) {
    const auto within = [code](std::uint32_t first, std::uint32_t last) { return code >= first && code <= last; };
    const bool control = code < 0x20 || within(0x7f, 0x9f);
    const bool direction = within(0x200e, 0x200f) || within(0x2028, 0x202e) || within(0x2066, 0x2069) || code == 0x61c;
    return !control && !direction && !within(0xd800, 0xdfff) && code <= 0x10ffff;
}

/// UTF-8 [RFC3629]: the first byte says how many follow, and no character is longer than it has to be.
Character first_of(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
    const std::uint32_t lead = byte(0);
    if (lead < 0x80) return {1, is_shown(lead)};
    const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc0 || lead > 0xf4 || text.size() < bytes) return {};
    std::uint32_t code = lead & (0x7fu >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return {};
        code = code << 6 | (byte(i) & 0x3f);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (code < least[bytes]) return {};
    return {bytes, is_shown(code)};
}

std::string shown(std::string_view text, bool keeps_lines) {
    std::string line;
    line.reserve(text.size());
    while (!text.empty()) {
        const Character next = first_of(text);
        if (next.shown || (keeps_lines && text.front() == '\n'))
            line += text.substr(0, next.bytes);
        else
            line += '?';
        text.remove_prefix(next.bytes);
    }
    return line;
}

/// Smallest number of edits of single letters, and of swaps of two neighbours. [Levenshtein1966]
std::size_t edits(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> rows(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            std::size_t& least = rows[i][j];
            least = std::max(i, j);
            if (i == 0 || j == 0) continue;
            least = std::min({rows[i - 1][j] + 1, rows[i][j - 1] + 1,
                              rows[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? std::size_t{0} : std::size_t{1})});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                least = std::min(least, rows[i - 2][j - 2] + 1);
        }
    return rows[a.size()][b.size()];
}

}  // namespace

std::string nearest_word(std::string_view word, std::span<const std::string_view> words) {
    constexpr std::size_t longest = 100;
    const std::string said = lower_case(word.substr(0, longest));
    // chosen: a letter in three may be wrong; three letters that it begins with are near, too.
    std::size_t least = (said.size() + 1) / 3 + 1;
    std::string nearest;
    for (const std::string_view candidate : words) {
        const std::string other = lower_case(candidate.substr(0, longest));
        const bool begins = said.size() >= 3 && (other.starts_with(said) || said.starts_with(other));
        const std::size_t distance = begins ? std::size_t{1} : edits(said, other);
        // Words at an edit distance of their whole length have nothing in common.
        if (distance >= least || distance >= std::max(said.size(), other.size())) continue;
        least = distance;
        nearest = candidate;
    }
    return nearest;
}

std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

std::string ending_of(const std::filesystem::path& file) {
    return lower_case(file.extension().string());
}

std::string printable(std::string_view text) {
    return shown(text, false);
}

std::string printable_lines(std::string_view text) {
    return shown(text, true);
}

std::string counted(std::size_t count, std::string_view noun) {
    return std::to_string(count) + " " + std::string(noun) + (count == 1 ? "" : "s");
}

std::vector<std::string_view> words_in(std::string_view text) {
    std::vector<std::string_view> words;
    for (std::size_t end = 0; !text.empty(); text.remove_prefix(std::min(end + 1, text.size()))) {
        end = std::min(text.find(' '), text.size());
        words.push_back(text.substr(0, end));
    }
    return words;
}

}  // namespace render2mpeg::core
