#pragma once
// Shots of a film, and the windows of frames that stand for them.
#include <cstdint>
#include <vector>

#include "app/job/render_job.h"

namespace render2mpeg::app {

/// Frames where another camera begins; they begin a group of pictures and find light anew.
std::vector<std::int64_t> cuts_of(const RenderJob& film);

int camera_at(const RenderJob& film, std::int64_t frame);

/// The middles of `count` equal parts, or the whole film if it is no longer.
std::vector<Chunk> middle_windows(const RenderJob& film, int count, int length);

/// Parts of chunks between cuts, each with its chunk's index.
std::vector<Chunk> stretches_of(const RenderJob& film, const std::vector<Chunk>& chunks);

/// Each stretch's middle frames, with its place among them as its index.
std::vector<Chunk> middles_of(const std::vector<Chunk>& stretches, int length);

/// Of each shot.
std::vector<Chunk> windows_of_shots(const RenderJob& film, int length);

struct SampleWindows {
    std::vector<Chunk> all;
    std::vector<double> weights;  ///< frames that each stands for; empty: all alike

    std::int64_t frames() const;
};

/// One for each shot, or of many shots `most` even ones, none of which has a cut in it.
SampleWindows sample_windows(const RenderJob& film, int most, int length);

}  // namespace render2mpeg::app
