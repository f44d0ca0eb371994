#pragma once
// Time, size, memory and disk of a film, from a few of its frames that are lit now.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/loop/observer.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"

namespace render2mpeg::app {

/// CPU seconds and coded bytes of one frame, by its place in a film.
struct FrameCost {
    double seconds = 0, bytes = 0;
};

/// Frames that were lit and coded: the first of each window, which also makes all that a chunk begins with, and those
/// behind it.
struct FrameSample {
    FrameCost first, later;
    int frames = 0, windows = 0;
    Size size;
    double cpu = 0, clock = 0;  ///< seconds of all of it
    double built = 0;           ///< CPU of what a run builds once
    RunStatistics statistics;   ///< of sample_frames() alone

    /// The same in pictures of so many times the pixels; `power` of the pixels for the seconds.
    FrameSample grown(double times, double power) const;
};

/// Lights and codes windows of a film, each as a film of its own, and adds to the statistics what that takes. None
/// where `frame_done` said false, or where `stops`, which ends a frame in its midst, left not one of them.
std::optional<FrameSample> light_windows(RenderJob film, renderer::Renderer& renderer,
                                         const std::vector<Chunk>& windows, LoopObserver& observer,
                                         RunStatistics& statistics, const std::function<bool()>& frame_done,
                                         const std::function<bool()>& stops = &InterruptGuard::requested);

/// The same with a renderer of its own, until `limit` (clock_seconds()) or an interrupt: none where less than a frame
/// of each kind is known.
std::optional<FrameSample> sample_frames(const RenderJob& job, const std::vector<Chunk>& windows, double limit,
                                         LoopObserver& observer, Progress& progress);

/// The film in pictures `scale` times as wide and high, about.
RenderJob resized(const RenderJob& film, double scale);

/// `count` windows of `length` frames, the middles of equal parts of the film, or the whole of it where it has no more.
std::vector<Chunk> middle_windows(const RenderJob& film, int count, int length);

/// CPU seconds and bytes of the whole film by one frame of each kind, but for what is built once.
FrameCost film_by(const RenderJob& film, const FrameSample& sample);

/// What a film will take. Times are of this machine, as busy as it was while the sample was lit.
struct Forecast {
    double cpu = 0, clock = 0;  ///< seconds of all threads, and on the clock
    double bytes = 0;           ///< of the file, sound apart; of all images where it is not coded
    double disk = 0;            ///< bytes that are taken while it is made
    double spread = 0;          ///< time and size are within this share of them in nine of ten films
    std::uint64_t memory = 0;   ///< bytes
    FrameSample sample;         ///< as it was lit
    FrameCost first, later;     ///< a frame of each kind, in the film's size
};

/// `output`: its ending says what its container takes; empty: .mpg. Lights windows of the film in ever larger pictures
/// until some `within` seconds on the clock are over. Settles the film's exposure where that is open. None where it
/// was interrupted.
std::optional<Forecast> forecast(RenderJob& film, const std::filesystem::path& output, double within, bool quiet);

/// What is rendered, in one line: frames, size, rate, camera, lights.
std::string film_text(const RenderJob& film);

/// What it takes, as lines of a text.
std::string text_of(const Forecast& forecast);

}  // namespace render2mpeg::app
