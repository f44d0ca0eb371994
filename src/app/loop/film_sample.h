#pragma once
// Lights and codes windows of a film, to tell what the whole of it takes.
#include <cstdint>
#include <optional>
#include <vector>

#include "app/loop/observer.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/chunk.h"
#include "app/system/progress.h"

namespace render2mpeg::app {

/// Frames that are unlike the one before, ascending, the film's first apart: the camera is another one, or a light
/// comes or goes. Nothing that is known of a picture before tells what they take.
struct AbruptFrames {
    std::vector<std::int64_t> cuts, switches;

    bool contains(std::int64_t frame) const;
    std::size_t count() const { return cuts.size() + switches.size(); }
};
AbruptFrames abrupt_frames(const RenderJob& film);

/// What the frames of a window took.
struct SampleWindow {
    std::int64_t first = 0;       ///< frame
    std::vector<double> seconds;  ///< CPU; of the first with what begins a chunk
    std::vector<double> lights;   ///< of these: what does not depend on the picture's size
    std::vector<double> bytes;
};

/// What windows of one size took.
struct FilmSample {
    std::vector<SampleWindow> windows;
    double cpu = 0, clock = 0;  ///< seconds of all of it, but for what is built once
    double built = 0;           ///< CPU to build what never changes
    RunStatistics statistics;   ///< CPU by stage and by row of the plan

    int frames() const;
};

/// Lights and codes the windows; `frame_done` is called after each frame. Fewer frames where `limit` (clock_seconds())
/// passes, but three of the first window; none where somebody interrupted.
std::optional<FilmSample> light_sample(const RenderJob& job, const std::vector<Chunk>& windows, double limit,
                                       LoopObserver& observer, Progress& progress);

/// The film in pictures `scale` times as wide and high, about.
RenderJob resized(const RenderJob& film, double scale);

/// Windows in the middles of equal parts of the film, at most its frames; moved within their parts to where they have
/// an abrupt frame behind their first, where there is one.
std::vector<Chunk> sample_windows(const RenderJob& film, int count, int length, const AbruptFrames& abrupt);

/// CPU seconds that a chunk of `frames` frames takes, from those of a window's frames: the first counts once, those
/// behind it as they are, and what the window does not reach as its last half.
double chunk_seconds(const std::vector<double>& window, std::int64_t frames);

/// What the whole film takes, by a sample of its pictures at the film's size or a smaller one.
struct SampledFilm {
    double cpu = 0;               ///< seconds, but for what is built once
    double bytes = 0;             ///< of all pictures
    double first = 0, later = 0;  ///< CPU seconds of a chunk's first frame, and of others
    double apart = 0;             ///< half of what windows differ by in time, over their mean; 0 with one window
};
SampledFilm film_by(const FilmSample& sample, const RenderJob& film, const RenderJob& sampled,
                    const AbruptFrames& abrupt);

}  // namespace render2mpeg::app
