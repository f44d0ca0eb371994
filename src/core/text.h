#pragma once
// Text that comes from outside: lower case, endings of files, what a terminal may show.
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Text that comes from outside: names of files, and what stands in them.
namespace render2mpeg::core {

/// A to Z become a to z; all other bytes stay, whatever the locale.
std::string lower_case(std::string_view text);

/// The ending of a file's name in lower case, with its dot: ".ts" of "FILM.TS". Empty where there is none. Endings say
/// what a file holds, whatever their case.
std::string ending_of(const std::filesystem::path& file);

/// One line that is safe on a terminal: control codes (of ASCII and of Unicode), changes of the direction of writing,
/// line separators and what is no UTF-8 become '?' each.
std::string printable(std::string_view text);

/// The same, but lines stay lines.
std::string printable_lines(std::string_view text);

/// Of the words that one may have meant by `word`, the one that takes the fewest insertions, deletions, changes and
/// swaps of neighbouring letters to become, or that begins with it; empty where none is near.
std::string nearest_word(std::string_view word, std::span<const std::string_view> words);

/// `; did you mean WORD?` with that word between `before` and `after`; empty where none is near.
template <class Words>
std::string did_you_mean(std::string_view word, const Words& words, const std::string& before = "",
                         const std::string& after = "") {
    const std::string nearest = nearest_word(word, std::vector<std::string_view>(words.begin(), words.end()));
    return nearest.empty() ? "" : "; did you mean " + before + nearest + after + "?";
}

}  // namespace render2mpeg::core
