#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "checks/tree.h"

/// Checks of the documents: short enough to be read, and there where comments name them.
namespace render2mpeg::checks {

/// The most words that a Markdown file below a path may have.
struct WordLimit {
    std::string_view path;  ///< a file, or a folder with '/' at its end
    int words = 0;
};
/// The table of limits. A file takes the first row that its path begins with; files without a row have no limit.
const std::vector<WordLimit>& word_limits();

/// Words of a text: parts between blanks that hold a letter or a digit.
int count_words(std::string_view text);

std::vector<Finding> wordy_documents(const std::vector<File>& files);

/// The most words that the changelog may say of a release.
constexpr int words_of_a_release = 600;
/// Releases, from one heading of the second level to the next, of which a changelog says more; found at their headings.
std::vector<Finding> wordy_releases(const File& changelog);

/// Documents that comments and pages name, as in `docs/model/lightcut.md` or `docs/decisions`, and files that
/// pages name, as in `src/renderer/cut/gatherer.h`, that do not exist below `root`. The name may leave out what follows
/// a dot or a hyphen.
std::vector<Finding> missing_files(const std::vector<File>& files, const std::filesystem::path& root);

}  // namespace render2mpeg::checks
