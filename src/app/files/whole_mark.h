#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

/// How a finished film is known again: its first file carries, as an extended attribute, what it was made from. Its
/// bytes know nothing of that, no other file lies beside it, and what takes its name does not have the mark. A file
/// system without such attributes, or a copy that leaves them behind, makes a film that nobody knows.
namespace render2mpeg::app {

/// What a render leaves when it is done.
struct Products {
    std::vector<std::filesystem::path> frames;  ///< the film, or its images; not empty
    std::vector<std::filesystem::path> beside;  ///< heatmaps, statistics, reports
};

/// Marks the products as whole. `identity` says of which film (film_identity.h). A mark that cannot be set is none.
void mark_as_whole(const Products& products, const nlohmann::json& identity);

/// What is known of products that may be whole.
struct Wholeness {
    enum class State {
        unknown,  ///< nothing: there is no mark
        other,    ///< they are another film's, or were changed since
        lacking,  ///< they are this film's, without some of what is asked for beside it
        whole,
    };
    State state = State::unknown;
    std::string difference;  ///< other: what differs first, as difference_of(); lacking: the first file that lacks
};

Wholeness wholeness_of(const Products& products, const nlohmann::json& identity);

}  // namespace render2mpeg::app
