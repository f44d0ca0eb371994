#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

/// The project's own files as the checks see them.
namespace render2mpeg::checks {

/// A text file. For C++ files, `code` and `comments` are the text with everything else blanked, so that an offset means
/// the same place in all three: `code` lacks comments and the insides of literals, `comments` has the insides of
/// comments alone. For other files `code` is empty and `comments` is the whole text, since their prose may cite as
/// well.
struct File {
    std::string path;  ///< relative to the root, with '/'
    std::string text;
    std::string code;
    std::string comments;

    bool is_cpp() const;
    /// Neither a test nor a benchmark: what users run.
    bool is_product() const;
    bool begins_with(std::string_view folder) const { return path.starts_with(folder); }
};

/// What a check found wrong, and where.
struct Finding {
    std::string path;
    int line = 0;  ///< from 1; 0: the whole file
    std::string message;

    bool operator==(const Finding&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Finding& finding);

/// One finding per line, for a failing test's message.
std::string list_of(const std::vector<Finding>& findings);

File make_file(std::string path, std::string text);

/// All text files below `root` by path, without build folders, films and what git keeps for itself.
std::vector<File> read_tree(const std::filesystem::path& root);

/// The line, from 1, that an offset lies in.
int line_at(std::string_view text, std::size_t offset);

std::vector<std::string_view> lines_of(std::string_view text);

/// Whether a character may stand in a name: a letter, digit or underscore.
bool is_word(char c);

/// Offsets of a word in a text; whole words only: no letter, digit or underscore beside it.
std::vector<std::size_t> find_word(std::string_view text, std::string_view word);

/// An #include line.
struct Include {
    std::string name;
    bool quoted = false;
    int line = 0;
};
std::vector<Include> includes_of(const File& file);

}  // namespace render2mpeg::checks
