#pragma once
// Tries in child processes what libraries of others read.
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "scene/isolation/child_trial.h"
#include "scene/model/animation.h"

/// What is read with libraries that are not ours is read in child processes first (scene/child_trial.h).
namespace render2mpeg::app {

/// How many images are tried side by side, what each may take while others are, and one by itself, which one that
/// needs more is tried once more; in bytes.
struct ImageTrials {
    std::size_t at_once = 1;
    std::uintmax_t share = 0, alone = 0;
};

/// One at a time where --memory holds this process to a limit, which its children inherit; else as many as there are
/// threads, which share the machine's memory.
ImageTrials image_trials(bool held_to_limit);

/// Reads the scene's images, one in each process. Throws core::Error for an image on which its library crashes, never
/// ends, or takes all memory. What they refuse otherwise is not told here: not every image is looked at. Returns
/// whether all were tried, and no interrupt came between.
bool try_images(const scene::Animation& film, const ImageTrials& trials);

/// What decoding a film may take.
scene::TrialLimits film_limits(const std::filesystem::path& film);

}  // namespace render2mpeg::app
