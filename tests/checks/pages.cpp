#include "checks/pages.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <string_view>
#include <utility>

#include "checks/citations.h"

namespace render2mpeg::checks {
namespace {

/// "src/app/loop" of "src/app/loop/pipeline.cpp".
std::string room_of(const std::string& path) {
    return path.substr(0, path.rfind('/'));
}
std::string stem_of(const std::string& path) {
    return path.substr(0, path.rfind('.'));
}
std::string name_of(const std::string& path) {
    return path.substr(path.rfind('/') + 1);
}

/// A header, its source, or both.
struct Pair {
    const File* header = nullptr;
    const File* source = nullptr;

    const File& any() const { return header != nullptr ? *header : *source; }
    std::string duty() const {
        std::string duty = header != nullptr ? duty_of(*header) : "";
        return duty.empty() && source != nullptr ? duty_of(*source) : duty;
    }
};

/// By stem, sorted.
std::map<std::string, Pair> pairs_of(const std::vector<File>& files) {
    std::map<std::string, Pair> pairs;
    for (const File& file : files) {
        if (!file.is_product()) continue;
        Pair& pair = pairs[stem_of(file.path)];
        (file.path.ends_with(".h") ? pair.header : pair.source) = &file;
    }
    return pairs;
}

/// Text as a cell of a table shows it: code in backquotes stays as it is.
std::string cell(std::string_view text) {
    std::string result;
    bool code = false;
    for (const char c : text) {
        if (c == '`') code = !code;
        if (c == '|')
            result += "\\|";
        else if (c == '<' && !code)
            result += "&lt;";
        else
            result += c;
    }
    return result;
}

/// How two names are sorted so that 7.10 comes after 7.9.
bool comes_before(const std::string& a, const std::string& b) {
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
        if (digit(a[i]) && digit(b[j])) {
            std::size_t ai = i, bj = j;
            while (ai < a.size() && digit(a[ai])) ++ai;
            while (bj < b.size() && digit(b[bj])) ++bj;
            const long left = std::stol(a.substr(i, ai - i)), right = std::stol(b.substr(j, bj - j));
            if (left != right) return left < right;
            i = ai;
            j = bj;
        } else {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i;
            ++j;
        }
    }
    return a.size() - i < b.size() - j;
}
struct Natural {
    bool operator()(const std::string& a, const std::string& b) const { return comes_before(a, b); }
};

/// "eq. 7.1 and 7.2" as "eq. 7.1" and "eq. 7.2"; other places as they are.
std::vector<std::string> places_of(const std::string& place) {
    static const std::regex head("^eqs?\\. *"), number("[0-9]+(\\.[0-9]+)*[a-z]?");
    std::smatch match;
    if (!std::regex_search(place, match, head)) return {place};
    const std::string rest = match.suffix();
    std::vector<std::string> places;
    for (std::sregex_iterator it(rest.begin(), rest.end(), number), end; it != end; ++it)
        places.push_back("eq. " + it->str());
    return places;
}

/// Where one place of a work is followed and explained.
struct Uses {
    std::set<std::string> files, pages;
};

std::string list_of_paths(const std::set<std::string>& paths) {
    std::string text;
    for (const std::string& path : paths) text += (text.empty() ? "`" : ", `") + path + "`";
    return text;
}

/// What a work is: its row in docs/sources.md.
std::map<std::string, std::string> works_of(const File& sources) {
    std::map<std::string, std::string> works;
    for (const std::string_view line : lines_of(sources.text)) {
        const std::size_t middle = line.find(" | ", 2);
        if (line.starts_with("| ") && middle != std::string_view::npos && line.size() > middle + 5)
            works[std::string(line.substr(2, middle - 2))] = line.substr(middle + 3, line.size() - middle - 5);
    }
    return works;
}

}  // namespace

std::string duty_of(const File& file) {
    std::string comment;
    for (const std::string_view line : lines_of(file.text)) {
        const bool is_comment = line.starts_with("// ") || line.starts_with("/// ");
        if (!is_comment && comment.empty()) continue;
        if (!is_comment) break;
        const std::size_t begin = line.find(' ') + 1;
        comment += (comment.empty() ? "" : " ") + std::string(line.substr(begin));
    }
    // A sentence ends with a point before a capital letter; abbreviations do not.
    static const std::regex end("\\.(?= +[A-Z`\\[(])");
    for (std::sregex_iterator it(comment.begin(), comment.end(), end), none; it != none; ++it) {
        const std::string before = comment.substr(0, static_cast<std::size_t>(it->position()));
        if (before.ends_with("e.g") || before.ends_with("i.e") || before.ends_with(" eq")) continue;
        return before + ".";
    }
    return comment;
}

std::string structure_page(const std::vector<File>& files) {
    std::string page =
        "# Structure\n\n"
        "Every file of the program and the library, by room. A row is a header and its source. The "
        "duty is the first\nsentence of the file itself. Arrows between rooms are proved by "
        "`tests/checks/layers_test.cpp`.\n";
    std::string room;
    std::map<std::string, std::map<std::string, Pair>> rooms;
    for (const auto& [stem, pair] : pairs_of(files)) rooms[room_of(stem)][stem] = pair;
    for (const auto& [name, pairs] : rooms) {
        page += "\n## " + name + "\n\n";
        page += "| file | duty |\n|---|---|\n";
        for (const auto& [stem, pair] : pairs) {
            std::string names = name_of(pair.any().path);
            if (pair.header != nullptr && pair.source != nullptr) names += ", .cpp";
            page += "| " + names + " | " + cell(pair.duty()) + " |\n";
        }
    }
    return page;
}

std::vector<Finding> files_without_duty(const std::vector<File>& files) {
    std::vector<Finding> findings;
    for (const auto& [stem, pair] : pairs_of(files))
        if (pair.duty().empty()) findings.push_back({pair.any().path, 0, "has no comment that says what it is for"});
    return findings;
}

std::string equations_page(const std::vector<File>& files) {
    const auto sources =
        std::find_if(files.begin(), files.end(), [](const File& f) { return f.path == "docs/sources.md"; });
    if (sources == files.end()) return "";
    const std::vector<std::string> listed = listed_keys(*sources);
    const auto works = works_of(*sources);

    std::map<std::string, std::map<std::string, Uses, Natural>> uses;
    for (const File& file : files) {
        const bool is_page = file.begins_with("docs/model");
        if (!file.is_product() && !is_page) continue;
        for (const Citation& citation : citations_in(file, listed))
            for (const std::string& place : places_of(citation.place)) {
                Uses& there = uses[citation.key][place.empty() ? "as a whole" : place];
                (is_page ? there.pages : there.files).insert(file.path);
            }
    }

    std::string page =
        "# From an equation to its file\n\n"
        "Every place of every work that the code cites, and the files that follow it. "
        "`docs/sources.md` lists the works.\n";
    for (const std::string& key : listed) {
        const auto found = uses.find(key);
        if (found == uses.end()) continue;
        page += "\n## " + key + "\n\n" + works.at(key) + "\n\n| place | files | explained in |\n|---|---|---|\n";
        for (const auto& [place, there] : found->second)
            page +=
                "| " + cell(place) + " | " + list_of_paths(there.files) + " | " + list_of_paths(there.pages) + " |\n";
    }
    return page;
}

}  // namespace render2mpeg::checks
