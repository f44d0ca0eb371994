#pragma once
// Refuses to replace a film or to make a folder without a word.
#include <filesystem>
#include <vector>

#include "app/files/publish.h"

namespace render2mpeg::app {

/// What a run is going to write.
struct Wishes {
    std::vector<Files> films;                   ///< what took long to make: not to be replaced without a word
    std::vector<std::filesystem::path> beside;  ///< figures, pages, folders of frames; an empty name is passed over
};

/// Throws core::Error where a film is there already or a folder is missing, unless it was `agreed`. Empty files, pipes
/// and devices are no films. Writes nothing.
void require_consent(const Wishes& wishes, bool agreed);

/// Lines about all that it would refuse; for runs that write nothing.
std::vector<std::string> doubts_about(const Wishes& wishes);

}  // namespace render2mpeg::app
