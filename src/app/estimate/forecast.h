#pragma once
// Time and size of a film, by a sample of its frames.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/estimate/memory_need.h"
#include "app/job/render_job.h"
#include "app/loop/sample.h"

namespace render2mpeg::app {

/// Exponents by which seconds and bytes grow with the pixels.
struct Growth {
    FrameCost first, later;
};

/// A sample's costs in `times` its pixels.
FrameSample grown(const FrameSample& sample, double times, const Growth& growth);

/// What two samples of a film's windows tell, together with what is usual of others; what one tells alone is usual.
Growth growth_between(const FrameSample* smaller, const FrameSample& larger);

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

/// A film's need of memory by a sample of two small pictures, in seconds; as told where that was interrupted.
MemoryNeed sampled(const RenderJob& film, const MemoryNeed& need);

/// One line: frames, size, rate, camera, lights.
std::string film_text(const RenderJob& film);

std::string text_of(const Forecast& forecast);

}  // namespace render2mpeg::app
