#pragma once
// Time and size of a film, by a sample of its frames.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/loop/memory_need.h"
#include "app/loop/observer.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/loop/shots.h"
#include "app/options/film.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"

namespace render2mpeg::app {

/// CPU seconds and coded bytes of one frame, by its place in a film.
struct FrameCost {
    double seconds = 0, bytes = 0;
};

/// Exponents by which seconds and bytes grow with the pixels.
struct Growth {
    FrameCost first, later;
};

/// Sample of lit and coded frames: the first of each window, with a chunk's start, and later ones.
struct FrameSample {
    FrameCost first, later;
    int frames = 0, windows = 0;
    Size size;
    encoder::Codec codec = encoder::Codec::mpeg2;
    double cpu = 0, clock = 0;  ///< seconds of all of it
    double built = 0;           ///< CPU of a run's one-time construction
    RunStatistics statistics;   ///< of sample_frames() alone

    /// The same with the pixels multiplied by `times`.
    FrameSample grown(double times, const Growth& growth) const;
};

/// What two samples of a film's windows tell, together with what is usual of others; what one tells alone is usual.
Growth growth_between(const FrameSample* smaller, const FrameSample& larger);

/// Lights and codes windows of a film as films of their own. None where `frame_done` said false; without frames where
/// `stops` ended the first one.
std::optional<FrameSample> light_windows(RenderJob film, renderer::Renderer& renderer,
                                         const std::vector<Chunk>& windows, LoopObserver& observer,
                                         RunStatistics& statistics, const std::function<bool()>& frame_done,
                                         const std::function<bool()>& stops = &InterruptGuard::requested);

/// The same with its own renderer until `is_over`; none after an interrupt. Without a later frame these are reckoned.
/// `weights` of the windows' later frames; empty: all alike.
std::optional<FrameSample> sample_frames(
    const RenderJob& job, const std::vector<Chunk>& windows, LoopObserver& observer, Progress& progress,
    const std::function<bool()>& is_over = [] { return false; }, const std::vector<double>& weights = {});

/// CPU seconds of each of the film's frames beside others, by what its camera sees in small pictures, lit beside
/// `renderer`. Empty where one camera sees all, or where that takes too much of the time of `frames` that are to be
/// lit.
std::vector<double> prices_of(const RenderJob& film, std::int64_t frames, renderer::Renderer& renderer);

/// By how much pictures of the film are scaled so that their longest side has `side` pixels, or as many more as its
/// codec takes; at most 1.
double scale_for(const RenderJob& film, double side);
RenderJob resized(const RenderJob& film, double scale);

/// CPU seconds and bytes of the whole film by its sample, without one-time work.
FrameCost film_by(const RenderJob& film, const FrameSample& sample);

/// Times are of this machine under its load while the sample was lit.
struct Forecast {
    double cpu = 0, clock = 0;  ///< seconds of all threads, and on the clock
    double once = 0;            ///< of `cpu`, what every process begins with
    double bytes = 0;           ///< of the file, its sound included; of all images where it is not coded
    double disk = 0;            ///< bytes that are taken while it is made
    double spread = 0;          ///< time and size are within this share of them in nine of ten films
    std::uint64_t memory = 0;   ///< bytes
    bool is_least = false;      ///< no frame was lit in time: it takes more, and its size is not known
    FrameSample sample;         ///< as it was lit
    FrameCost first, later;     ///< a frame of each kind, in the film's size
};

/// Lights windows in ever larger pictures for about `within` seconds, of which those spent on other programs do not
/// count, and settles the exposure. `output`'s ending tells the container; empty: .mpg. None after an interruption.
std::optional<Forecast> forecast(RenderJob& film, const std::filesystem::path& output, double within, bool quiet);

/// One line: frames, size, rate, camera, lights.
std::string film_text(const RenderJob& film);

std::string text_of(const Forecast& forecast);

}  // namespace render2mpeg::app
