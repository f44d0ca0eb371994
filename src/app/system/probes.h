#pragma once
// Has probes read images first, and limits what films may take.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "scene/isolation/probed.h"
#include "scene/model/animation.h"

/// What is read with libraries that are not ours is read by probes first (scene/isolation/probe.h).
namespace render2mpeg::app {

/// The images that surfaces or the sky show, by their numbers.
std::set<int> images_of(const scene::Animation& film);

/// How many processes look at images side by side, what each image may take while others are looked at, and one by
/// itself, which one that needs more is tried once more; in bytes.
struct ImageProbes {
    std::size_t at_once = 1;
    std::uintmax_t share = 0, alone = 0;
};

/// One where --memory holds this process to a limit, which its probes inherit; else as many as there are threads, which
/// share the machine's memory.
ImageProbes image_probes(bool held_to_limit);

/// Lets probes read the scene's images. Throws core::Error for an image on which its library crashes, never ends, or
/// takes all memory. What they refuse otherwise is not told here: not every image is looked at. Returns whether all
/// were read, and no interrupt came between.
bool probe_images(const scene::Animation& film, const ImageProbes& probes);

/// The probe's side: reads the images that its standard input holds. Says a '.' for each.
std::string read_probed_images(const scene::TakeTurns& take_turns);

/// Lets a probe decode a film's sound. Throws core::Error where it cannot be read.
void probe_sound(const std::filesystem::path& file);

/// What decoding a film may take.
scene::ProbeLimits film_limits(const std::filesystem::path& film);

}  // namespace render2mpeg::app
