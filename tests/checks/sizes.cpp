#include "checks/sizes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <string_view>

#include "tests/support/program.h"

namespace render2mpeg::checks {
namespace {

std::size_t indent_of(std::string_view line) {
    return std::min(line.find_first_not_of(' '), line.size());
}

/// Whether a line that ends in '{' opens a function: it has a parameter list, and neither names a scope nor steers a
/// flow.
bool opens_function(std::string_view head) {
    constexpr std::array<std::string_view, 14> others = {"namespace", "class", "struct", "enum",  "union",
                                                         "extern",    "if",    "for",    "while", "switch",
                                                         "do",        "else",  "try",    "} "};
    for (const std::string_view word : others)
        if (head.starts_with(word)) return false;
    return head.find('(') != std::string_view::npos && head.find("= {") == std::string_view::npos;
}

/// Whether a line above a head belongs to something else: it is empty, ends a statement, a scope or a label, or is a
/// template's first line or the preprocessor's.
bool ends_what_came_before(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == std::string_view::npos) return true;
    const std::string_view last = line.substr(line.find_last_not_of(' '));
    return std::string_view(";{}:").find(last[0]) != std::string_view::npos || line[begin] == '#' ||
           line.substr(begin).starts_with("template");
}

/// The line above that a line goes on with, if it does: a list that ends in a comma goes on below comments, whatever
/// the indent of a wrapped element before.
std::optional<std::size_t> continued_by(const std::vector<std::string_view>& lines, std::size_t line) {
    if (line == 0) return std::nullopt;
    std::size_t above = line - 1;
    while (above > 0 && indent_of(lines[above]) == lines[above].size()) --above;
    if (lines[above].ends_with(",")) return above;
    const std::size_t indent = indent_of(lines[line]);
    const bool continues = indent >= indent_of(lines[line - 1]) || lines[line].substr(indent).starts_with(": ");
    if (!continues || ends_what_came_before(lines[line - 1])) return std::nullopt;
    return line - 1;
}

}  // namespace

std::vector<Finding> large_files(const std::filesystem::path& root) {
    const std::string names =
        support::run("git -C '" + root.string() + "' ls-files -z --cached --others --exclude-standard").output;
    std::istringstream stream(names);
    std::vector<Finding> findings;
    for (std::string name; std::getline(stream, name, '\0');) {
        std::error_code missing;
        const std::uintmax_t bytes = std::filesystem::file_size(root / name, missing);
        if (!missing && bytes > largest_file)
            findings.push_back({name, 0, std::to_string(bytes) + " bytes, of at most " + std::to_string(largest_file)});
    }
    return findings;
}

std::vector<Finding> oversized_files(const std::vector<File>& files) {
    std::vector<Finding> findings;
    for (const File& file : files) {
        if (!file.is_cpp()) continue;
        const int lines = static_cast<int>(lines_of(file.text).size());
        if (lines > longest_file)
            findings.push_back(
                {file.path, 0, std::to_string(lines) + " lines, of at most " + std::to_string(longest_file)});
    }
    return findings;
}

std::vector<Function> functions_in(const File& file) {
    const std::vector<std::string_view> lines = lines_of(file.code);
    std::vector<Function> functions;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        // Find where a body opens, and go back over wrapped parameters and a constructor's initialisers to where its
        // head begins.
        if (!lines[i].ends_with("{")) continue;
        std::size_t first = i;
        while (const std::optional<std::size_t> above = continued_by(lines, first)) first = *above;
        const std::size_t indent = indent_of(lines[first]);
        const std::string_view head = lines[first].substr(indent);
        if (!opens_function(head)) continue;

        // The body ends at the first brace that stands where the head begins.
        std::size_t last = i + 1;
        while (last < lines.size() &&
               !(indent_of(lines[last]) == indent && lines[last].substr(indent).starts_with("}")))
            ++last;
        functions.push_back({std::string(head), static_cast<int>(first) + 1, static_cast<int>(last - first) + 1});
        i = last;
    }
    return functions;
}

std::vector<Finding> oversized_functions(const std::vector<File>& files) {
    std::vector<Finding> findings;
    for (const File& file : files) {
        if (!file.is_product()) continue;
        for (const Function& function : functions_in(file))
            if (function.lines > longest_function)
                findings.push_back(
                    {file.path, function.line, std::to_string(function.lines) + " lines: " + function.head});
    }
    return findings;
}

}  // namespace render2mpeg::checks
