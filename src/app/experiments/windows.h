#pragma once
// Which frames of a film stand for it.
#include <cstdint>
#include <set>
#include <vector>

#include "app/options/chunk.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// Stretches of a film that stand for it: the middles of equal parts, as many as there is room for, each coded as a
/// chunk of its own.
std::vector<Chunk> windows_of(FrameRange film, const Sample& sample);

/// The frames of a window that are lit by every light point: the last alone, or pairs of adjacent ones at even
/// distances, of which the last ends the window, and an odd one about its middle. `count` is 0 to the window's frames.
std::set<std::int64_t> reference_frames(const Chunk& window, int count);

}  // namespace render2mpeg::app
