#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

/// How a finished film is known again: its first file carries, as an extended attribute, a checksum of what it was made
/// from, and what was made beside it. No other file lies beside it, and what takes its name does not have the mark. A
/// file system without such attributes, or a copy that leaves them behind, makes a film that nobody knows: it is made
/// anew.
namespace render2mpeg::app {

/// What a render leaves when it is done.
struct Products {
    std::vector<std::filesystem::path> frames;  ///< the film, or its images; not empty
    std::vector<std::filesystem::path> beside;  ///< heatmaps, statistics, reports
};

/// Marks the products as whole. `identity` says of which film (film_identity.h). A mark that cannot be set is none.
void mark_as_whole(const Products& products, const nlohmann::json& identity);

/// Whether the products are marked as this film's, with all that is asked for beside it, and are as they were then.
bool is_whole(const Products& products, const nlohmann::json& identity);

}  // namespace render2mpeg::app
