#pragma once

#include <filesystem>

#include "scene/animation.h"
#include "scene/child_trial.h"

/// What is read with libraries that are not ours is read in child processes first (scene/child_trial.h).
namespace render2mpeg::app {

/// Reads the scene's images, one in each process, as many at a time as there are threads. Throws core::Error for an
/// image on which its library crashes, never ends, or takes all memory. What they refuse is not told here: not every
/// image is looked at.
void try_images(const scene::Animation& film);

/// What decoding a film may take.
scene::TrialLimits film_limits(const std::filesystem::path& film);

}  // namespace render2mpeg::app
