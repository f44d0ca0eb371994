#pragma once
// Sample windows of a film.
#include <vector>

#include "app/loop/render_job.h"
#include "app/options/film.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// Middles of equal parts of the film, as many as there is room for, each coded as a chunk.
std::vector<Chunk> windows_of(FrameRange film, const Sample& sample);

/// The middle frames of each shot, where there are cuts and no more than eight shots; else as windows_of().
std::vector<Chunk> windows_by_shot(const RenderJob& film, const Sample& sample);

}  // namespace render2mpeg::app
