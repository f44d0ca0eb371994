#pragma once
// What differs between the identities of two films.
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace render2mpeg::app {

/// What differs first between two films' identities, in words a user can act on ("--quantiser was 4 and is 6"); empty
/// where nothing does.
std::string difference_of(const nlohmann::json& before, const nlohmann::json& now);

}  // namespace render2mpeg::app
