#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "checks/tree.h"

/// Whether documents lead where they say.
namespace render2mpeg::checks {

/// A link of a Markdown file to another place in this tree.
struct Link {
    std::string path;    ///< as written; empty: this very file
    std::string anchor;  ///< behind '#'; empty: none
    int line = 0;
};

/// Links and pictures of a Markdown file; without those to other hosts, and without what stands in code.
std::vector<Link> links_in(const File& file);

/// The anchors of a Markdown file's headings, as code forges make them: lower case, without punctuation, blanks as '-',
/// "-1" and so on behind those that stand there already.
std::vector<std::string> anchors_of(const File& file);

/// Links of Markdown files to files that do not exist below `root`, and to headings that a file lacks.
std::vector<Finding> dead_links(const std::vector<File>& files, const std::filesystem::path& root);

}  // namespace render2mpeg::checks
