#include "checks/links.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <set>

namespace render2mpeg::checks {
namespace {

namespace fs = std::filesystem;

bool is_markdown(const File& file) {
    return file.path.ends_with(".md");
}

bool is_fence(std::string_view line) {
    const std::size_t first = line.find_first_not_of(' ');
    return first != std::string_view::npos &&
           (line.substr(first).starts_with("```") || line.substr(first).starts_with("~~~"));
}

/// The text with fenced and inline code blanked; every character stays at its place.
std::string without_code(std::string_view text) {
    std::string result(text);
    bool fenced = false;
    std::size_t at = 0;
    for (const std::string_view line : lines_of(text)) {
        const bool fence = is_fence(line);
        bool inside = fenced || fence;
        for (std::size_t i = 0; i < line.size(); ++i) {
            if (!fenced && !fence && line[i] == '`') inside = !inside;
            if (inside || line[i] == '`') result[at + i] = ' ';
        }
        if (fence) fenced = !fenced;
        at += line.size() + 1;
    }
    return result;
}

std::string anchor_of(std::string_view heading) {
    std::string anchor;
    for (const char c : heading) {
        const unsigned char u = static_cast<unsigned char>(c);
        if (c == ' ')
            anchor += '-';
        else if (std::isalnum(u) != 0 || c == '-' || c == '_' || u >= 0x80)
            anchor += static_cast<char>(std::tolower(u));
    }
    return anchor;
}

/// A path in the tree, '/' between folders and without "..".
std::string joined(const std::string& from, const std::string& to) {
    return (fs::path(from).parent_path() / to).lexically_normal().generic_string();
}

}  // namespace

std::vector<Link> links_in(const File& file) {
    static const std::regex markdown("\\]\\(([^()\\s]+)\\)"), html("(?:src|href)=\"([^\"]+)\"");
    const std::string text = without_code(file.text);
    std::vector<Link> links;
    for (const std::regex& form : {markdown, html})
        for (std::sregex_iterator it(text.begin(), text.end(), form), end; it != end; ++it) {
            const std::string target = (*it)[1];
            if (target.find("://") != std::string::npos || target.starts_with("mailto:")) continue;
            const std::size_t hash = std::min(target.find('#'), target.size());
            links.push_back({target.substr(0, hash), target.substr(std::min(hash + 1, target.size())),
                             line_at(text, static_cast<std::size_t>(it->position()))});
        }
    return links;
}

std::vector<std::string> anchors_of(const File& file) {
    std::vector<std::string> anchors;
    std::map<std::string, int> seen;
    bool fenced = false;
    for (const std::string_view line : lines_of(file.text)) {
        if (is_fence(line)) fenced = !fenced;
        const std::size_t level = std::min(line.find_first_not_of('#'), line.size());
        if (fenced || level == 0 || level > 6 || level == line.size() || line[level] != ' ') continue;
        // A link in a heading counts by its text alone.
        const std::string heading =
            std::regex_replace(std::string(line.substr(level + 1)), std::regex("\\[([^\\]]*)\\]\\([^)]*\\)"), "$1");
        const std::string anchor = anchor_of(heading);
        const int before = seen[anchor]++;
        anchors.push_back(before == 0 ? anchor : anchor + "-" + std::to_string(before));
    }
    return anchors;
}

std::vector<Finding> dead_links(const std::vector<File>& files, const fs::path& root) {
    std::set<std::string> known;
    std::map<std::string, std::vector<std::string>> anchors;
    for (const File& file : files) {
        known.insert(file.path);
        if (is_markdown(file)) anchors[file.path] = anchors_of(file);
    }

    std::vector<Finding> findings;
    for (const File& file : files) {
        if (!is_markdown(file)) continue;
        for (const Link& link : links_in(file)) {
            const std::string target = link.path.empty() ? file.path : joined(file.path, link.path);
            if (!known.contains(target) && !fs::exists(root / target)) {
                findings.push_back({file.path, link.line, "links to " + target + ", which does not exist"});
                continue;
            }
            const auto& there = anchors[target];
            if (!link.anchor.empty() && std::find(there.begin(), there.end(), link.anchor) == there.end())
                findings.push_back({file.path, link.line, "links to #" + link.anchor + ", which " + target + " lacks"});
        }
    }
    return findings;
}

}  // namespace render2mpeg::checks
