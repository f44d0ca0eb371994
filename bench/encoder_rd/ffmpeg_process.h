#pragma once

#include <string>
#include <vector>

namespace render2mpeg::bench {

/// What a program printed, and what it cost.
struct Finished {
    std::string text;
    double seconds = 0;  ///< CPU
};

/// Runs a command without a shell; both its outputs together are the text. Throws core::Error where it fails.
Finished run_program(std::vector<std::string> words);

}  // namespace render2mpeg::bench
