#pragma once

#include <string>
#include <vector>

#include "checks/tree.h"

/// "Every formula, constant and tolerance has a birth certificate": the checks that each one leads somewhere.
namespace render2mpeg::checks {

/// A key in square brackets in a comment or a document, as in `[Walter2005, eq. 5]`.
struct Citation {
    std::string key;
    int line = 0;
    std::string place = {};  ///< "eq. 5"; empty where the whole work is cited
};

/// What a file cites. A bracket is a citation if its key is listed, or has the form of a key (letters, then a year), or
/// is followed by a place (", eq. 3", ", table 6-4", ", 5.2"); so that `a[i]`, `[[nodiscard]]`, `[0, 1)` and lambdas
/// are none.
std::vector<Citation> citations_in(const File& file, const std::vector<std::string>& listed);

/// The keys in the table of docs/sources.md, in its order.
std::vector<std::string> listed_keys(const File& sources);

/// Keys cited but not listed, listed but never cited, listed twice or out of order.
std::vector<Finding> citation_faults(const std::vector<File>& files);

/// Places in documents that are cited as `docs/measurements.md#records` and that no heading there makes.
std::vector<Finding> place_faults(const std::vector<File>& files);

}  // namespace render2mpeg::checks
