#include "checks/style.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace render2mpeg::checks {
namespace {

/// The identifier that follows an offset, blanks skipped.
std::string_view identifier_behind(std::string_view text, std::size_t at) {
    while (at < text.size() && text[at] == ' ') ++at;
    std::size_t end = at;
    while (end < text.size() && is_word(text[end])) ++end;
    return text.substr(at, end - at);
}

void look_for_words(const File& file, std::string_view text, std::initializer_list<std::string_view> words,
                    const std::string& why, std::vector<Finding>& findings) {
    for (const std::string_view word : words)
        for (const std::size_t at : find_word(text, word))
            findings.push_back({file.path, line_at(text, at), std::string(word) + ": " + why});
}

void look_at_lines(const File& file, std::vector<Finding>& findings) {
    int number = 0;
    for (const std::string_view line : lines_of(file.text)) {
        ++number;
        if (line.ends_with('\r')) findings.push_back({file.path, number, "ends in CR"});
        if (line.ends_with(' ') || line.ends_with('\t')) findings.push_back({file.path, number, "ends in a blank"});
        if (line.find('\t') != std::string_view::npos) findings.push_back({file.path, number, "has a tab"});
        for (const char sign : {'<', '=', '>'}) {
            const std::string mark(7, sign);
            if (line == mark || line.starts_with(mark + " "))
                findings.push_back({file.path, number, "is a mark of a merge conflict"});
        }
    }
    if (!file.text.empty() && !file.text.ends_with('\n')) findings.push_back({file.path, number, "has no line end"});
    if (file.text.ends_with("\n\n")) findings.push_back({file.path, number, "is an empty line at the end"});
}

/// Files whose words are somebody's: embedded binary text may spell anything.
bool is_prose_or_code(const File& file) {
    return !file.path.ends_with(".gltf") && !file.path.ends_with(".json");
}

}  // namespace

std::vector<Finding> leftovers(const std::vector<File>& files) {
    std::vector<Finding> findings;
    for (const File& file : files) {
        look_at_lines(file, findings);
        if (!is_prose_or_code(file) || file.begins_with("tests/checks/")) continue;
        look_for_words(file, file.text, {"TODO", "FIXME", "XXX", "HACK"}, "unfinished work is not left in the tree",
                       findings);
        for (const std::string_view place : {"/home/", "/root/", "/work/", "/Users/"})
            for (std::size_t at = file.text.find(place); at != std::string::npos; at = file.text.find(place, at + 1)) {
                if (at > 0 && (is_word(file.text[at - 1]) || file.text[at - 1] == '.' || file.text[at - 1] == '}'))
                    continue;
                findings.push_back(
                    {file.path, line_at(file.text, at), std::string(place) + ": a path of somebody's machine"});
            }
    }
    return findings;
}

std::vector<Finding> unhouselike_names(const std::vector<File>& files) {
    constexpr std::array<std::string_view, 6> endings = {"Manager", "Helper", "Util", "Utils", "Data", "Info"};
    std::vector<Finding> findings;
    for (const File& file : files) {
        if (!file.is_cpp()) continue;
        for (const std::string_view kind : {"class", "struct", "enum"})
            for (const std::size_t at : find_word(file.code, kind)) {
                const std::string_view name = identifier_behind(file.code, at + kind.size());
                for (const std::string_view ending : endings)
                    if (name.ends_with(ending))
                        findings.push_back({file.path, line_at(file.code, at),
                                            std::string(name) + ": says nothing by " + std::string(ending)});
            }
        for (std::size_t at = file.code.find("get_"); at != std::string::npos; at = file.code.find("get_", at + 1)) {
            // Ours begin with it, and are not members of somebody else's namespace.
            const bool glued = at > 0 && (is_word(file.code[at - 1]) || file.code[at - 1] == ':' ||
                                          file.code[at - 1] == '.' || file.code[at - 1] == '>');
            if (!glued)
                findings.push_back({file.path, line_at(file.code, at), "get_: a function is a verb, a value a noun"});
        }
        look_for_words(file, file.code, {"std::expected", "std::mdspan", "std::format"}, "g++ 12 and clang 14 lack it",
                       findings);
        if (file.path.ends_with(".h") && !file.text.starts_with("#pragma once\n"))
            findings.push_back({file.path, 1, "a header opens with #pragma once"});
    }
    return findings;
}

std::vector<Finding> forbidden_calls(const std::vector<File>& files) {
    std::vector<Finding> findings;
    for (const File& file : files) {
        if (!file.is_product()) continue;
        look_for_words(file, file.code, {"std::rand", "std::random_device", "std::mt19937", "std::mt19937_64", "srand"},
                       "random numbers here have no state (core/sampling.h)", findings);
        // Programs may: ours, and the one that shows how the encoder is used.
        if (file.begins_with("src/app/") || file.begins_with("encoder/example/")) continue;
        look_for_words(file, file.code,
                       {"std::cout", "std::cerr", "std::clog", "std::printf", "std::puts", "printf", "puts",
                        "fmt::print", "perror"},
                       "parts never print", findings);
        // _exit ends a child process, which must not run what its parent left to be run at exit.
        look_for_words(file, file.code, {"exit", "abort", "std::terminate", "quick_exit"}, "parts never exit",
                       findings);
    }
    return findings;
}

}  // namespace render2mpeg::checks
