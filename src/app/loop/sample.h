#pragma once
// Frames of a film that stand for it: in which size, which ones, and what they cost.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/job/render_job.h"
#include "app/job/shots.h"
#include "app/loop/observer.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"

namespace render2mpeg::app {

/// CPU time grows with this power of the pixels where one size alone is known. fit: bench/fits/forecast.jsonl
inline constexpr double time_power = 0.5;

/// CPU seconds and coded bytes of one frame, by its place in a film.
struct FrameCost {
    double seconds = 0, bytes = 0;
};

/// Costs of a window's first frame, with a chunk's start, and of its later ones.
struct WindowCost {
    FrameCost first, later;
    std::int64_t frames = 0;
    double cpu = 0;  ///< seconds of all
};

/// Means over windows that were lit and coded.
struct FrameSample {
    FrameCost first, later;
    std::vector<WindowCost> windows;
    int frames = 0;
    Size size;
    encoder::Codec codec = encoder::Codec::mpeg2;
    double cpu = 0, clock = 0;  ///< seconds of all of it
    double built = 0;           ///< CPU of a run's one-time construction
    RunStatistics statistics;
};

/// Windows of a film in the size in which they are lit.
struct Sample {
    RenderJob film;
    SampleWindows windows;
};

/// By how much the film's pictures are scaled so that their longest side has `side` pixels, or as many more as its
/// codec takes; at most 1.
double scale_for(const RenderJob& film, double side);

/// The film in pictures of this scale, or of as much more as its codec takes, in one pass and without audit.
RenderJob resized(const RenderJob& film, double scale);

/// Lights and codes each window as a film of its own. None where `frame_done` said false; without frames where `stops`
/// ended the first one. Later frames that were not lit in time are reckoned.
std::optional<FrameSample> light_sample(const Sample& sample, renderer::Renderer& renderer, LoopObserver& observer,
                                        const std::function<bool()>& frame_done,
                                        const std::function<bool()>& stops = &InterruptGuard::requested);

/// The same with its own renderer until `is_over`; none after an interrupt.
std::optional<FrameSample> sample_frames(const Sample& sample, LoopObserver& observer, Progress& progress,
                                         const std::function<bool()>& is_over);

/// Costs of `length` frames in the middle of each stretch, in pictures of 32 pixels lit by the renderer that `make`
/// gives for them. Empty where they take more than a thirtieth of the time of `frames` of the film, and after an
/// interrupt.
std::vector<WindowCost> small_costs(const RenderJob& film, const std::vector<Chunk>& stretches, int length,
                                    std::int64_t frames, bool quiet,
                                    const std::function<std::unique_ptr<renderer::Renderer>(const RenderJob&)>& make);

/// CPU seconds of each of the film's frames beside others, by what its camera sees in small pictures, lit beside
/// `renderer`. Empty where one camera sees all, or where that takes too much of the time of `frames` that are to be
/// lit.
std::vector<double> prices_of(const RenderJob& film, std::int64_t frames, renderer::Renderer& renderer);

}  // namespace render2mpeg::app
