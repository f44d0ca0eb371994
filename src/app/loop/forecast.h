#pragma once
// Time, size, memory and disk of a film, by a sample of its frames.
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

/// Estimated memory in bytes, before anything is allocated (docs/measurements.md#memory).
struct MemoryNeed {
    std::uint64_t held = 0;       ///< by this process now: program, scene as it was read
    std::uint64_t triangles = 0;  ///< trees of rays, and what chooses anchors
    std::uint64_t textures = 0;   ///< with their smaller copies
    std::uint64_t decoding = 0;   ///< of the largest image, while it is read
    std::uint64_t lights = 0;     ///< light points and their trees
    std::uint64_t frames = 0;     ///< visibility, light and pictures in flight
    std::uint64_t moving = 0;     ///< of `triangles`, those with trees of their own in each chunk at work

    std::uint64_t total() const { return held + triangles + textures + decoding + lights + frames; }
    /// Of another chunk that is made beside the first.
    std::uint64_t of_chunk() const { return moving + lights + frames; }
};

/// Reads the headers of all images. Throws core::Error.
MemoryNeed memory_need(const RenderJob& film);

/// Whether `threads` may decode images at once within `limit`, else one after the other. Throws core::Error where even
/// that is too much.
bool may_decode_at_once(const RenderJob& film, const MemoryNeed& need, std::uint64_t limit, int threads);

/// CPU seconds and coded bytes of one frame, by its place in a film.
struct FrameCost {
    double seconds = 0, bytes = 0;
};

/// Sample of lit and coded frames: the first of each window, with a chunk's start, and later ones.
struct FrameSample {
    FrameCost first, later;
    int frames = 0, windows = 0;
    Size size;
    double cpu = 0, clock = 0;  ///< seconds of all of it
    double built = 0;           ///< CPU of a run's one-time construction
    RunStatistics statistics;   ///< of sample_frames() alone

    /// The same with the pixels multiplied by `times`; seconds grow by `power`.
    FrameSample grown(double times, double power) const;
};

/// Lights and codes windows of a film as films of their own. None where `frame_done` said false, or `stops` ended the
/// first window within a frame.
std::optional<FrameSample> light_windows(RenderJob film, renderer::Renderer& renderer,
                                         const std::vector<Chunk>& windows, LoopObserver& observer,
                                         RunStatistics& statistics, const std::function<bool()>& frame_done,
                                         const std::function<bool()>& stops = &InterruptGuard::requested);

/// The same with its own renderer until `is_over` or an interrupt; none with less than one frame of each kind.
std::optional<FrameSample> sample_frames(
    const RenderJob& job, const std::vector<Chunk>& windows, LoopObserver& observer, Progress& progress,
    const std::function<bool()>& is_over = [] { return false; });

/// Frames where another camera begins; they begin a group of pictures and find light anew.
std::vector<std::int64_t> cuts_of(const RenderJob& film);

RenderJob resized(const RenderJob& film, double scale);

/// The middles of `count` equal parts, or the whole film if it is no longer.
std::vector<Chunk> middle_windows(const RenderJob& film, int count, int length);

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
