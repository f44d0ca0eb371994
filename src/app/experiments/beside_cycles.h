#pragma once
// `compare --beside cycles`.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/options/options.h"

namespace render2mpeg::app {

/// Windows of a .blend's film by this program and by Cycles with a denoiser, coded alike, against a truth by Cycles
/// (blender/beside_cycles/compare.py). Exit status: 0, or 130 after an interruption. Throws core::Error, also without
/// Blender or ffmpeg.
int compare_beside_cycles(const TrialOptions& options, const std::vector<std::string>& words);

/// What was found (docs/json.md, "Beside Cycles") in a sentence or two.
std::string sentence_of_peers(const nlohmann::json& found);

}  // namespace render2mpeg::app
