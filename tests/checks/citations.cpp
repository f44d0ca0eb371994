#include "checks/citations.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <string_view>

#include "checks/links.h"

namespace render2mpeg::checks {
namespace {

constexpr std::string_view sources_path = "docs/sources.md";

bool is_alnum(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0;
}
bool is_digit(char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool is_alpha(char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0;
}

/// Letters, a year of this century or the last, perhaps a letter: "Walter2005", "Herzog2008b".
bool looks_like_a_key(std::string_view key) {
    if (!key.empty() && is_alpha(key.back())) key.remove_suffix(1);
    if (key.size() < 6 || !std::all_of(key.end() - 4, key.end(), is_digit)) return false;
    const std::string_view century = key.substr(key.size() - 4, 2);
    const std::string_view name = key.substr(0, key.size() - 4);
    return (century == "19" || century == "20") && std::all_of(name.begin(), name.end(), is_alpha);
}

/// What follows a key's comma where it names a place in a work.
bool looks_like_a_place(std::string_view place) {
    while (!place.empty() && std::isspace(static_cast<unsigned char>(place.front()))) place.remove_prefix(1);
    for (const std::string_view word :
         {"eq", "table", "fig", "section", "annex", "appendix", "algorithm", "chapter", "clause", "listing", "page"})
        if (place.starts_with(word)) return true;
    // "5.2" is a place; in "[width, 3]" the 3 is an index.
    const std::size_t dot = place.find_first_not_of("0123456789");
    return dot != std::string_view::npos && dot > 0 && place[dot] == '.' && dot + 1 < place.size() &&
           is_digit(place[dot + 1]);
}

/// Folds the line ends inside a bracket, comment signs included, to blanks of the same length.
std::string unwrapped(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c == '\n' || c == '/' || c == '*') c = ' ';
    return result;
}

/// Words parted by one blank each.
std::string without_extra_blanks(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == ' ' && (result.empty() || result.back() == ' ')) continue;
        result += c;
    }
    while (!result.empty() && result.back() == ' ') result.pop_back();
    return result;
}

const File* find_file(const std::vector<File>& files, std::string_view path) {
    const auto it = std::find_if(files.begin(), files.end(), [&](const File& f) { return f.path == path; });
    return it == files.end() ? nullptr : &*it;
}

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

}  // namespace

std::vector<Citation> citations_in(const File& file, const std::vector<std::string>& listed) {
    constexpr std::size_t longest = 200;  // of a bracket: chosen, the longest citation in use has some 60 characters
    const std::string_view text = file.comments;
    std::vector<Citation> found;
    for (std::size_t open = text.find('['); open != std::string_view::npos; open = text.find('[', open + 1)) {
        if (open > 0 && (is_alnum(text[open - 1]) || text[open - 1] == '_' || text[open - 1] == ']')) continue;
        const std::size_t close = text.find_first_of("[]", open + 1);
        if (close == std::string_view::npos || text[close] == '[' || close - open > longest) continue;

        // A bracket may hold several citations, parted by semicolons.
        std::string inside = unwrapped(text.substr(open + 1, close - open - 1));
        for (std::size_t begin = 0; begin <= inside.size();) {
            const std::size_t end = std::min(inside.find(';', begin), inside.size());
            std::string_view one = std::string_view(inside).substr(begin, end - begin);
            const std::size_t first = std::min(one.find_first_not_of(' '), one.size());
            begin = end + 1;
            one.remove_prefix(first);
            const std::size_t comma = std::min(one.find(','), one.size());
            const std::string key(one.substr(0, comma));
            if (key.size() < 2 || !is_alpha(key[0])) continue;
            if (!std::all_of(key.begin(), key.end(),
                             [](char c) { return is_alnum(c) || c == '_' || c == '-' || c == '.'; }))
                continue;
            const bool is_listed = std::find(listed.begin(), listed.end(), key) != listed.end();
            const bool has_place = comma < one.size() && looks_like_a_place(one.substr(comma + 1));
            if (!is_listed && !looks_like_a_key(key) && !has_place) continue;
            const std::string_view place = one.substr(std::min(comma + 1, one.size()));
            found.push_back({key, line_at(text, open), without_extra_blanks(place)});
        }
    }
    return found;
}

std::vector<std::string> listed_keys(const File& sources) {
    std::vector<std::string> keys;
    for (const std::string_view line : lines_of(sources.text)) {
        if (!line.starts_with("| ") || line.starts_with("| key |")) continue;
        const std::size_t end = line.find(" |", 2);
        if (end != std::string_view::npos) keys.emplace_back(line.substr(2, end - 2));
    }
    return keys;
}

std::vector<Finding> citation_faults(const std::vector<File>& files) {
    const std::string path(sources_path);
    const File* sources = find_file(files, path);
    if (sources == nullptr) return {{path, 0, "is missing"}};
    const std::vector<std::string> listed = listed_keys(*sources);

    // Each key that is cited is listed.
    std::vector<Finding> findings;
    std::set<std::string> cited;
    for (const File& file : files) {
        if (file.path == path || file.begins_with("tests/checks/")) continue;
        for (const Citation& citation : citations_in(file, listed)) {
            cited.insert(citation.key);
            if (std::find(listed.begin(), listed.end(), citation.key) == listed.end())
                findings.push_back(
                    {file.path, citation.line, "cites [" + citation.key + "], which " + path + " does not list"});
        }
    }

    // Each key that is listed is cited, once, and stands in its place.
    for (std::size_t i = 0; i < listed.size(); ++i) {
        if (!cited.contains(listed[i])) findings.push_back({path, 0, "lists " + listed[i] + ", which nothing cites"});
        if (i > 0 && lower(listed[i - 1]) >= lower(listed[i]))
            findings.push_back(
                {path, 0, listed[i] + " stands behind " + listed[i - 1] + ": the table is sorted, without doubles"});
    }
    return findings;
}

std::vector<Finding> place_faults(const std::vector<File>& files) {
    static const std::regex cited("\\bdocs/[\\w/-]+\\.md#[\\w-]+");
    std::map<std::string, std::set<std::string>> places;
    for (const File& file : files)
        if (file.path.ends_with(".md"))
            for (const std::string& anchor : anchors_of(file)) places[file.path].insert(anchor);

    std::vector<Finding> findings;
    for (const File& file : files) {
        if (file.begins_with("tests/checks/") || file.comments.find(".md#") == std::string::npos) continue;
        for (std::sregex_iterator at(file.comments.begin(), file.comments.end(), cited), end; at != end; ++at) {
            const std::string place = at->str();
            const std::size_t hash = place.find('#');
            if (!places[place.substr(0, hash)].contains(place.substr(hash + 1)))
                findings.push_back({file.path, line_at(file.comments, static_cast<std::size_t>(at->position())),
                                    "names " + place + ", which does not exist"});
        }
    }
    return findings;
}

}  // namespace render2mpeg::checks
