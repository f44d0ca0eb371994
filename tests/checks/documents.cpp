#include "checks/documents.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <string>

namespace render2mpeg::checks {
namespace {

bool is_blank(char c) {
    return std::isspace(static_cast<unsigned char>(c)) != 0;
}

/// Bytes of UTF-8 beyond ASCII count as letters.
bool is_letter_or_digit(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80;
}

/// Whether a folder holds a file whose name begins with what the last part of `path` leaves off.
bool exists_but_for_its_end(const std::filesystem::path& path) {
    if (std::filesystem::exists(path)) return true;
    if (!std::filesystem::is_directory(path.parent_path())) return false;
    const std::string begin = path.filename().string();
    for (const auto& entry : std::filesystem::directory_iterator(path.parent_path())) {
        const std::string name = entry.path().filename().string();
        if (name.size() > begin.size() && name.starts_with(begin) &&
            std::string_view(".-").find(name[begin.size()]) != std::string_view::npos)
            return true;
    }
    return false;
}

}  // namespace

const std::vector<WordLimit>& word_limits() {
    // chosen: what can be read in five minutes, in ten, and in twenty.
    static const std::vector<WordLimit> limits = {
        {"README.md", 800}, {"docs/model/", 2500}, {"docs/decisions.md", 2500}, {"docs/", 4000}};
    return limits;
}

int count_words(std::string_view text) {
    int count = 0;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::find_if(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), is_blank);
        const std::string_view part = text.substr(at, static_cast<std::size_t>(end - text.begin()) - at);
        if (std::any_of(part.begin(), part.end(), is_letter_or_digit)) ++count;
        at += part.size() + 1;
    }
    return count;
}

std::vector<Finding> wordy_documents(const std::vector<File>& files) {
    std::vector<Finding> findings;
    for (const File& file : files) {
        if (!file.path.ends_with(".md")) continue;
        const auto limit = std::find_if(word_limits().begin(), word_limits().end(),
                                        [&](const WordLimit& l) { return file.begins_with(l.path); });
        if (limit == word_limits().end()) continue;
        const int words = count_words(file.text);
        if (words > limit->words)
            findings.push_back(
                {file.path, 0, std::to_string(words) + " words, of at most " + std::to_string(limit->words)});
    }
    return findings;
}

std::vector<Finding> wordy_releases(const File& changelog) {
    std::vector<Finding> findings;
    const std::string_view text = changelog.text;
    const auto heading_from = [&](std::size_t at) {
        return text.substr(at).starts_with("## ") ? at : std::min(text.find("\n## ", at), text.size() - 1) + 1;
    };
    for (std::size_t begin = heading_from(0); begin < text.size();) {
        const std::size_t below = std::min(text.find('\n', begin), text.size());
        const std::size_t end = below < text.size() ? heading_from(below) : text.size();
        const int words = count_words(text.substr(below, end - below));
        if (words > words_of_a_release)
            findings.push_back({changelog.path, line_at(text, begin),
                                std::to_string(words) + " words, of at most " + std::to_string(words_of_a_release)});
        begin = end;
    }
    return findings;
}

std::vector<Finding> missing_files(const std::vector<File>& files, const std::filesystem::path& root) {
    constexpr std::string_view documents[] = {"docs/"};
    constexpr std::string_view all[] = {"docs/",  "src/",   "perceptual/", "encoder/",
                                        "tests/", "bench/", "animations/", "scripts/"};
    const auto is_part = [](char c) {
        return (is_letter_or_digit(c) && c > 0) || c == '_' || c == '-' || c == '.' || c == '/';
    };
    std::vector<Finding> findings;
    for (const File& file : files) {
        // What was written of older versions names files as they were.
        if (file.begins_with("tests/checks/") || file.path == "CHANGELOG.md") continue;
        const std::string_view text = file.comments;
        const bool is_page = file.path.ends_with(".md");
        for (const std::string_view folder : is_page ? std::span<const std::string_view>(all) : documents) {
            for (std::size_t at = text.find(folder); at != std::string_view::npos; at = text.find(folder, at + 1)) {
                if (at > 0 && is_part(text[at - 1])) continue;  // of another folder
                std::size_t end = at + folder.size();
                while (end < text.size() && is_part(text[end])) ++end;
                if (end < text.size() && text[end] == '*') continue;  // of several files
                while (text[end - 1] == '.' || text[end - 1] == '/') --end;
                const std::string name(text.substr(at, end - at));
                if (!exists_but_for_its_end(root / name))
                    findings.push_back({file.path, line_at(text, at), "names " + name + ", which does not exist"});
            }
        }
    }
    return findings;
}

}  // namespace render2mpeg::checks
