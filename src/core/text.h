#pragma once
// Words: lower case, endings of files, counts, text that a terminal may show.
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace render2mpeg::core {

/// A to Z become a to z; all other bytes stay, whatever the locale.
std::string lower_case(std::string_view text);

/// Lower-case ending with its dot: ".ts" of "FILM.TS"; may be empty.
std::string ending_of(const std::filesystem::path& file);

/// One safe line for a terminal: control codes, changes of direction, line separators and invalid UTF-8 become '?'.
std::string printable(std::string_view text);

/// The same, but lines stay lines.
std::string printable_lines(std::string_view text);

/// `1 triangle`, `2 triangles`.
std::string counted(std::size_t count, std::string_view noun);

/// The words between spaces; they lie in the text.
std::vector<std::string_view> words_in(std::string_view text);

/// The word with the fewest edits (insertions, deletions, changes, swaps of neighbours) or a common beginning; empty
/// where none is near.
std::string nearest_word(std::string_view word, std::span<const std::string_view> words);

/// `; did you mean WORD?` with that word between `before` and `after`; empty where none is near.
template <class Words>
std::string did_you_mean(std::string_view word, const Words& words, const std::string& before = "",
                         const std::string& after = "") {
    const std::string nearest = nearest_word(word, std::vector<std::string_view>(words.begin(), words.end()));
    return nearest.empty() ? "" : "; did you mean " + before + nearest + after + "?";
}

}  // namespace render2mpeg::core
