#pragma once
// Top of a page: a table of choices with bars, a large picture, the command to paste; all else behind a fold.
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace render2mpeg::app {

/// How good something is, for the colour of its word.
enum class Grade { good, fair, poor, none };

/// One choice, as plain text.
struct AnswerRow {
    std::string name;
    double share = 0;  ///< of the longest bar, 0 to 1
    std::string bar;   ///< label under the bar
    std::string word;  ///< the difference in words
    Grade grade = Grade::none;
    std::string detail;  ///< under the word, soft
    std::string size;
    bool recommended = false;
    std::string note = {};     ///< under the name, soft
    std::string picture = {};  ///< HTML in place of the size
};

/// One of several ways to the same film, as the rule of all pages sees it.
struct Offer {
    double cost = 0;            ///< of any unit, the same for all
    bool is_like_best = false;  ///< indistinguishable from the best
};

/// The recommended row: the cheapest indistinguishable from the best. None where there is none.
std::optional<std::size_t> cheapest_alike(std::span<const Offer> offers);

/// "0:16 (28 s of CPU)": by the clock, and of all threads.
std::string time_text(double clock, double cpu);

/// Names of the columns.
struct AnswerHeads {
    std::string name, bar, word, size;
};

/// The table. Empty where there are no rows.
std::string answer_table(const AnswerHeads& heads, const std::vector<AnswerRow>& rows, const std::string& note);

/// Table and figure beside each other where there is room, the command below them.
std::string answer_screen(const std::string& table, const std::string& figure, const std::string& command);

/// A row of a table: plain text for each column.
struct TableRow {
    std::vector<std::string> cells;
    bool bold = false;   ///< the first of them
    bool faint = false;  ///< all
};

/// A table under its title. `kinds` has a letter for each column: `t` text, `n` a number, `b` a bar of so many per
/// cent. Without heads where they are all empty.
std::string html_table(const std::string& title, std::string_view kinds, const std::vector<std::string>& heads,
                       const std::vector<TableRow>& rows);

/// HTML behind a fold that opens at a click and on paper. Empty where there is nothing.
std::string folded(const std::string& title, const std::string& html);

}  // namespace render2mpeg::app
