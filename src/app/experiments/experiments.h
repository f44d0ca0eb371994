#pragma once
#include <functional>
#include <string>
#include <vector>

#include "app/loop/run_statistics.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg compare`: the same frames by this program and by rendering first and encoding with ffmpeg then
/// (docs/choosing.md). Returns the exit status: 0, or 130 after an interruption, with what was finished until then.
/// Throws core::Error, also where there is no ffmpeg.
int compare(const CompareOptions& options, const std::vector<std::string>& words);

/// `render2mpeg cost`: lights and codes a sample of a film with one tolerance after the other (docs/choosing.md).
/// Returns the exit status: 0, or 130 after an interruption, with what was finished until then. Throws core::Error.
int cost(const CostOptions& options, const std::vector<std::string>& words);

/// Makes a film as `render2mpeg render` does, and says what it comes to. Returns the exit status.
using RenderFilm = std::function<int(const RenderOptions& options, const std::string& command, Rendered* rendered)>;

/// `render2mpeg tune`: finds the setting that reaches a quality, rate, size or time on a sample of the film, then makes
/// the film with `render_film` (docs/choosing.md). `words` are the command line's. Returns the exit status: 0; 1 where
/// the target is out of reach or the film missed it; 130 after an interruption. Throws core::Error.
int tune(const TuneOptions& options, const std::vector<std::string>& words, const RenderFilm& render_film);

}  // namespace render2mpeg::app
