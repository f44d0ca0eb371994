#pragma once
// Asks before a film is replaced or a folder is made.
#include <filesystem>
#include <vector>

#include "app/files/publish.h"

namespace render2mpeg::app {

/// What a run is going to write.
struct Wishes {
    std::vector<Files> films;                   ///< what took long to make: not to be replaced without a word
    std::vector<std::filesystem::path> beside;  ///< figures, pages, folders of frames; an empty name is passed over
};

/// Asks on a terminal whether films that are there may be replaced, and folders that are missing made; throws
/// core::Error where there is no terminal, or the answer is no. Nothing is asked with `agreed`. Empty files, pipes and
/// devices are no films. Writes nothing.
void ask_consent(const Wishes& wishes, bool agreed);

/// What it would ask, as one line for each; for runs that write nothing.
std::vector<std::string> questions_about(const Wishes& wishes);

}  // namespace render2mpeg::app
