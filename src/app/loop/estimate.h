#pragma once
// What a whole film will take, from a few of its frames that are lit now.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"

namespace render2mpeg::app {

/// What a film will take. Times are of this machine, as busy as it was while the sample was lit.
struct FilmEstimate {
    int frames = 0;  ///< that were lit
    Size size;       ///< at which they were lit: the film's, or smaller where that would have taken too long
    double cpu = 0;  ///< seconds of all threads, for the whole film
    double clock = 0;
    double bytes = 0;             ///< of the file, sound apart; 0 where it is not coded
    double spread = 0;            ///< the film's time and size are likely within this share of them
    double first = 0, later = 0;  ///< CPU seconds of a chunk's first frame, with what begins a chunk, and of others
    std::uint64_t memory = 0;     ///< bytes
    RunStatistics sample;         ///< CPU by stage and by row of the plan, of the frames that were lit
};

/// `output`: its ending says what its container takes; empty: .mpg. Lights and codes windows of the film, and what is
/// measured before them, in about `within` seconds on the clock. Settles the film's exposure and light points where
/// they are open. None where it was interrupted.
std::optional<FilmEstimate> estimate_film(RenderJob& film, const std::filesystem::path& output, double within,
                                          bool quiet);

/// What is rendered, in one line: frames, size, rate, camera, lights.
std::string film_text(const RenderJob& film);

/// What it takes, as lines of a text.
std::string text_of(const FilmEstimate& estimate);

}  // namespace render2mpeg::app
