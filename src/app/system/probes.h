#pragma once
// Probes of images and films.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "scene/isolation/probe.h"
#include "scene/model/animation.h"

namespace render2mpeg::app {

/// Numbers of the images on surfaces and sky.
std::set<int> images_of(const scene::Animation& film);

/// Processes side by side, and bytes of memory for each of them, and for one alone on a second try.
struct ImageProbes {
    std::size_t at_once = 1;
    std::uintmax_t share = 0, alone = 0;
};

/// One under --memory, which probes inherit; else one per thread, sharing the machine's memory.
ImageProbes image_probes(bool held_to_limit);

/// Reads the scene's images in probes. Throws core::Error where a library crashes, hangs or takes all memory; other
/// refusals are not told. Whether nobody interrupted.
bool probe_images(const scene::Animation& film, const ImageProbes& probes);

/// Reads the images of standard input; '.' for each.
std::string read_probed_images(const scene::BeginLimits& begin_limits);

/// Decodes sound in a probe. Throws core::Error.
void probe_sound(const std::filesystem::path& file);

scene::ProbeLimits film_limits(const std::filesystem::path& film);

}  // namespace render2mpeg::app
